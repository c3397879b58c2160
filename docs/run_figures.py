"""The pictures of the paper's study in images/paper, with the captions of its report: `run-figures`."""

from pathlib import Path

import yaml
from docutils import nodes
from jinja2 import Template
from sphinx.util.docutils import SphinxDirective

PROJECT = Path(__file__).parent.parent
CAPTIONS = PROJECT / "workflow" / "report"
PICTURES = "images/paper"


def read_settings(name):
    """Return what the caption of a figure asks for: parts of its experiment, days and windows of the run.

    The suffix of a pair of figures, such as `_signed`, is none of the experiment's name.
    """
    name = name.removesuffix("_absolute").removesuffix("_signed")
    run, study = (
        yaml.safe_load((PROJECT / "config" / path).read_text(encoding="utf-8"))
        for path in ("config.yaml", "studies/paper.yaml")
    )
    study = study["study"]
    entry = {**study["evaluations"], **_partitions(study["partition"])}.get(name, {})
    return {
        "days": study["span_days"],
        "window_hours": run["estimation"]["window_hours"],
        "target": study["defaults"]["rso"],
        "curve": name.removesuffix("_curve"),
        "published": None,
        **study["orbit"],
        **study["defaults"],
        **({"stations": study["distribution"]} if name.startswith("error_distribution") else {}),
        **entry,
    }


def _partitions(partition):
    """Return the parts of the experiments that train on shares of the data, by their figures."""
    published = partition["published"]
    return {
        f"partition_{share}": {"train": f"random-{share}", "published": published.get(str(share))}
        for share in partition["shown"]
    }


def caption(name, figure):
    """Return what the report says below a figure; name: of the report's text."""
    text = (CAPTIONS / f"{name}.rst").read_text(encoding="utf-8")
    return Template(text).render(snakemake={"params": {"settings": read_settings(figure)}}).strip()


class RunFigures(SphinxDirective):
    """Pictures of a run; a line: a picture's name, what draws it, and its caption's name where another."""

    has_content = True

    def run(self):
        """Return the pictures below each other."""
        return [self._figure(*line.split()) for line in self.content]

    def _figure(self, name, _drawer, text=""):
        below = caption(text or name, name)
        image = nodes.image(uri=f"{PICTURES}/{name}.png", alt=below.split(". ")[0], loading="lazy")
        return nodes.figure("", image, nodes.caption("", below), ids=[name])


def link(app, doctree, docname):
    """Link the names of pictures in a page's text to the pictures."""
    shown = {name for figure in doctree.findall(nodes.figure) for name in figure["ids"]}
    for literal in list(doctree.findall(nodes.literal)):
        if (name := literal.astext()) in shown:
            led = nodes.reference("", "", literal.deepcopy(), internal=True, refuri=f"#{name}")
            literal.replace_self(led)
