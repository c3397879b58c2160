"""The documentation as a site (`make docs`). A link that leads nowhere is an error, and so is a page that the
sections in index.md leave out.

README.md and its like stand where a reader of the files looks for them. A page here includes each, and a link
between files of the project becomes one between pages.
"""

import inspect
import json
import posixpath
import re
import sys
from importlib.metadata import metadata
from importlib.util import find_spec
from pathlib import Path

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

import opml
from opml.workflow import prediction_files

sys.path.insert(0, str(Path(__file__).parent))
from run_figures import RunFigures, link
from schematics import Schematic

INCLUDED = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changes.md",
    "config/README.md": "settings.md",
    "config/keys.md": "settings.md",
    "src/opml/data/README.md": "sources.md",
}
FONTS = Path(find_spec("ziamath").origin).with_name("fonts")  # a wheel with STIX Two Math
LINKS = [line.split(", ") for line in metadata("opml-orbits").get_all("Project-URL") or ()]
SAMPLE = Path(opml.__file__).parent / "data" / "benchmark" / "sample" / "inputs" / "2026-01-13T060000"
SAMPLE_DATE = "2026-01-13T06:00:00"
BADGE = re.compile(r"^\[!\[.*\n", re.MULTILINE)  # a picture from elsewhere, which the site does not fetch
LINK = re.compile(r"\]\((?!\w+:|#)([^)\s#]+)")
ARTICLE = re.compile(r"<article[^>]*>(.*)</article>", re.DOTALL)
TAG = re.compile(r"<(?!/?section\b)[^>]*>|¶")
# A page from a folder may not read another one: the search finds the text of all here.
FETCH = """
const ROOT = new URL(".", location).pathname.length;
window.fetch = async address => new Response(
  `<div role="main">${PAGES[new URL(address, location).pathname.slice(ROOT)]}</div>`
);
"""
BAR = '<mo stretchy="false">|</mo>'
IMAGE = re.compile(r'<img [^>]*src="([^"]+)"[^>]*>')

project = "opml"
html_show_copyright = False
version = opml.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]

myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]  # as the hosting sites write equations
myst_heading_anchors = 4

default_role = "py:obj"  # names in docstrings
add_module_names = False
autodoc_preserve_defaults = True
autodoc_typehints_format = "short"
maximum_signature_line_length = 80

exclude_patterns = ["tables"]  # what programs write, for pages to include

html_theme = "furo"
html_title = f"opml {version}"
html_theme_options = {"footer_icons": [{"name": name, "url": url, "html": name} for name, url in LINKS]}
html_static_path = ["static", str(FONTS)]
html_css_files = ["opml.css"]
html_math_renderer = "mathml"
html_copy_source = False


def point(app, docname, source):
    """Point the links of a page at pages."""
    point_included(app, f"{docname}.md", docname, source)


def point_included(app, path, docname, source):
    """Point the links of a file that a page includes; path: from the folder of pages."""
    own, folder = (posixpath.dirname(posixpath.join("docs", file)) for file in (docname, path))

    def pointed(link):
        target = posixpath.normpath(posixpath.join(folder, link[1]))
        return "](" + INCLUDED.get(target, posixpath.relpath(target, own))

    source[0] = LINK.sub(pointed, BADGE.sub("", source[0]))


def list_parameters(app, what, name, obj, options, lines):
    """Make a list of what a function's docstring says of its parameters: `one: this; other: that.`"""
    if what == "function":
        names = "|".join(inspect.signature(obj).parameters)
        item = rf"(?:{names})(?:, (?:{names}))*: "
        paragraphs = [
            itemised(paragraph, item) if re.match(item, paragraph) else paragraph
            for paragraph in "\n".join(lines).split("\n\n")
        ]
        lines[:] = "\n\n".join(paragraphs).split("\n")


def itemised(paragraph, item):
    """Return a paragraph of items, whose first sentence lists them, as a list and what follows it."""
    listed, *rest = re.split(r"(?<=\.)\s+(?=[A-Z])", " ".join(paragraph.split()), maxsplit=1)
    items = re.split(f"; (?={item})", listed.rstrip("."))
    return "\n\n".join(["\n".join("* **{}:** {}".format(*one.split(": ", 1)) for one in items), *rest])


def typeset(equation, **options):
    """Return an equation as MathML, which needs no script; bars of a size have no room around them."""
    return tex2mathml(equation, **options).replace(BAR, BAR.replace(">", ' lspace="0" rspace="0">', 1))


def inline_equation(self, node):
    """Typeset an equation in a line."""
    self.body.append(typeset(node.astext()))
    raise nodes.SkipNode


def block_equation(self, node):
    """Typeset an equation of its own line."""
    self.body.append(f'<div class="equation">{typeset(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode


def enlarge(app, page, template, context, doctree):
    """Link each picture of a page to itself, which a phone shows as large as a finger makes it."""
    if "body" in context:
        context["body"] = IMAGE.sub(r'<a href="\1">\g<0></a>', context["body"])


def load_texts(app, page, template, context, doctree):
    """Give the search the text of all pages, to show where the words stand."""
    if page == "search":
        app.add_js_file("pages.js")


def write_texts(app, exception):
    """Write the text of all pages by the file's name, with the sections that links lead to."""
    if exception is None:
        names = [f"{page}.html" for page in sorted(app.env.found_docs)]
        found = {name: ARTICLE.search((app.outdir / name).read_text(encoding="utf-8")) for name in names}
        texts = {name: " ".join(TAG.sub("", article[1]).split()) for name, article in found.items()}
        script = f"const PAGES = {json.dumps(texts)};{FETCH}"
        (app.outdir / "_static" / "pages.js").write_text(script, encoding="utf-8")


def write_prediction(app, exception):
    """Write what `opml predict` writes of a simulated object: a page, and an orbit for globes (CZML)."""
    if exception is None:
        made = opml.predict(SAMPLE / "sets.tle", object=101, date=SAMPLE_DATE, weather=SAMPLE / "weather.csv")
        for suffix in ("html", "czml"):
            prediction_files.write(app.outdir / "_static" / f"prediction.{suffix}", made, {})


def setup(app):
    """Register what the settings above name."""
    app.connect("source-read", point)
    app.connect("include-read", point_included)
    app.connect("autodoc-process-docstring", list_parameters)
    app.connect("doctree-resolved", link)
    app.connect("html-page-context", enlarge)
    app.connect("html-page-context", load_texts)
    app.connect("build-finished", write_texts)
    app.connect("build-finished", write_prediction)
    app.add_directive("schematic", Schematic)
    app.add_directive("run-figures", RunFigures)
    app.add_html_math_renderer("mathml", (inline_equation, None), (block_equation, None))
    return {"parallel_read_safe": True}
