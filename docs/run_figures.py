"""The pictures of a finished run of the paper's study, scaled for a screen, with the captions of its report.

The directive `run-figures` takes them from the folder in OPML_FIGURES, or from results/figs. A line says
which are absent, and how they are made.
"""

import os
from html import escape
from pathlib import Path

import yaml
from docutils import nodes
from jinja2 import Template
from PIL import Image
from sphinx.util.docutils import SphinxDirective

PROJECT = Path(__file__).parent.parent
FIGURES = Path(os.environ.get("OPML_FIGURES", PROJECT / "results" / "figs"))
CAPTIONS = PROJECT / "workflow" / "report"
ABSENT = "Put here by `snakemake -j2` and `snakemake -j2 beyond`, then `make docs`: {}."
PIXELS, COLORS = 1200, 128
"""Width of a picture, and how many colours it keeps."""


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
        **(study["distribution"] if name.startswith("error_distribution") else {}),
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


def shrink(picture, target):
    """Write a picture in the width of a screen."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with Image.open(picture) as whole:
        height = round(whole.height * PIXELS / whole.width)
        small = whole.convert("RGB").resize((PIXELS, height), Image.Resampling.LANCZOS)
    small.quantize(COLORS, dither=Image.Dither.NONE).save(target, optimize=True)


class RunFigures(SphinxDirective):
    """Pictures of a run; a line of the text has a picture's name, and its caption's where that is another."""

    has_content = True

    def run(self):
        """Return the pictures that are there, below each other, and a line on those that are not."""
        self.env.note_reread()  # as the folder may have changed
        names = [line.split() for line in self.content]
        absent = [name for name, *_ in names if not (FIGURES / f"{name}.png").is_file()]
        note = ABSENT.format(", ".join(f"`{name}`" for name in absent))
        return [
            *(self.parse_text_to_nodes(note) if absent else []),
            *(self._figure(*parts) for parts in names if parts[0] not in absent),
        ]

    def _figure(self, name, text=""):
        shrink(FIGURES / f"{name}.png", Path(self.env.app.outdir) / "_images" / f"{name}.png")
        below = escape(caption(text or name, name))
        first = below.split(". ")[0]
        html = f'<figure><img alt="{first}" src="_images/{name}.png" loading="lazy"/>'
        return nodes.raw("", f"{html}<figcaption>{below}</figcaption></figure>", format="html")
