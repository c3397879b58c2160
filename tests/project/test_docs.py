"""The documentation: links lead somewhere, what it lists is what there is, and its site builds."""

import importlib.util
import json
import os
import re
import subprocess
import sys
import tomllib

import pytest
from support import REPOSITORY

import opml
from opml.environment import solar_activity
from validation.pages.__main__ import PAGES as WRITTEN

LINK = re.compile(r"\]\((?!\w+:|#)([^)\s#]+)")
PAGES = [
    REPOSITORY / "README.md",
    REPOSITORY / "CHANGELOG.md",
    REPOSITORY / "CONTRIBUTING.md",
    REPOSITORY / "config" / "README.md",
    REPOSITORY / "config" / "keys.md",
    REPOSITORY / "src" / "opml" / "data" / "README.md",
    *(REPOSITORY / "docs").glob("*.md"),
    *(REPOSITORY / "docs" / "data").glob("*.md"),
    *(REPOSITORY / "notes").glob("*.md"),
]
NOT_BY_HAND = {
    "reference.md",
    "changes.md",
    "contributing.md",
    *(path.name for path in WRITTEN if path.parts[0] == "docs" and len(path.parts) == 2),
}
"""Pages of docs/ that a program writes, or that only include a file from elsewhere."""


@pytest.mark.parametrize("folder", ["src/opml", "workflow"])
def test_what_is_printed_names_pages_as_installed_users_have_them(folder):
    for path in (REPOSITORY / folder).rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        docstrings = re.compile(r'^ *""".*?"""$|^ *#.*$', re.DOTALL | re.MULTILINE)
        assert "docs/" not in docstrings.sub("", text), path
        for page in re.findall(r"`opml docs ([a-z]+)`", text):
            assert (REPOSITORY / "docs" / f"{page}.md").is_file(), path


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(REPOSITORY).as_posix())
def test_links_between_files_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    assert [link for link in LINK.findall(text) if not (page.parent / link).exists()] == []


SPHINX = """
import runpy, sinking_histories
sinking_histories.seek_coarsely()  # of the site's prediction, to look at
runpy.run_module("sphinx", run_name="__main__")
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built without a warning."""
    if importlib.util.find_spec("sphinx") is None:
        pytest.skip("Sphinx is not installed: make docs")
    folder = tmp_path_factory.mktemp("site")
    options = ["-W", "--keep-going", "-q", "-d", str(folder / "doctrees"), "docs", str(folder / "html")]
    done = subprocess.run(
        [sys.executable, "-c", SPHINX, *options],
        cwd=REPOSITORY,
        env=os.environ | {"PYTHONPATH": "src:tests"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


@pytest.mark.slow
def test_every_page_is_in_the_site(site):
    assert {page.stem for page in site.glob("*.html")} >= {
        page.stem for page in (REPOSITORY / "docs").glob("*.md")
    }


@pytest.mark.slow
def test_the_menu_leads_home_and_has_the_version(site):
    text = (site / "theory.html").read_text(encoding="utf-8")
    assert re.search(r'<a class="reference internal" href="index.html">\s*Home\s*</a>', text)
    assert f'<span class="sidebar-brand-text">opml {opml.__version__}</span>' in text


@pytest.mark.slow
def test_the_search_shows_where_the_words_stand_from_a_folder_too(site):
    assert '<script src="_static/pages.js"></script>' in (site / "search.html").read_text(encoding="utf-8")
    script = (site / "_static" / "pages.js").read_text(encoding="utf-8")
    texts = json.loads(re.search(r"PAGES = ({.*});\n", script)[1])
    assert set(texts) >= {f"{page.stem}.html" for page in (REPOSITORY / "docs").glob("*.md")}
    section = (
        r'<section id="what-an-ephemeris-contains"> What an ephemeris contains Each epoch of an ephemeris'
    )
    assert re.search(section, texts["uncertainty.html"])
    assert set(re.findall(r"</?(\w+)", "".join(texts.values()))) == {"section"}


@pytest.mark.slow
def test_the_site_has_a_prediction_to_look_at(site):
    for name in ("prediction.html", "prediction.czml"):
        assert f'href="_static/{name}"' in (site / "elements.html").read_text(encoding="utf-8")
    assert "Expected error along the track" in (site / "_static" / "prediction.html").read_text("utf-8")
    assert json.loads((site / "_static" / "prediction.czml").read_text("utf-8"))[0]["id"] == "document"


@pytest.mark.slow
def test_the_reference_lists_parameters(site):
    text = (site / "reference.html").read_text(encoding="utf-8")
    listed = re.findall(r"<li><p><strong>([\w, ]+):</strong> ", text)
    assert {"gravity", "train, span_days, seed", "area_to_mass"} <= set(listed)
    assert "<p>Raises InputError where a source cannot be read or does not reach.</p>" in text


@pytest.mark.slow
def test_bars_of_a_size_have_no_room_around_them(site):
    text = (site / "theory.html").read_text(encoding="utf-8")
    bars = re.findall(r"<mo[^>]*>\|</mo>", text)
    assert len(bars) > 20
    assert '<mo stretchy="false">|</mo>' not in bars


def test_what_the_readme_links_to_is_a_page(site):
    first = (site / "index.html").read_text(encoding="utf-8")
    assert 'href="install.html"' in first
    assert 'href="contributing.html"' in first
    assert 'href="settings.html"' in first
    assert "README.md" not in re.findall(r'href="([^"]+)"', first)


@pytest.mark.slow
def test_pictures_of_the_site_open_in_full_size(site):
    for page in site.glob("*.html"):
        text = page.read_text(encoding="utf-8")
        for picture in re.findall(r'<img [^>]*src="(_images/[^"]+)"', text):
            assert re.search(rf'<a href="{picture}"><img ', text), page.name


@pytest.mark.slow
def test_the_method_is_drawn_in_the_page_s_ink_and_told_to_who_does_not_see_it(site):
    text = (site / "figures.html").read_text(encoding="utf-8")
    drawings = re.findall(r"<svg class=\"schematic\".*?</svg>", text, re.DOTALL)
    assert len(drawings) == 4
    for drawing in drawings:
        assert len(re.search(r'aria-label="([^"]+)"', drawing)[1].split()) > 20
        assert set(re.findall(r'<text [^>]*fill="([^"]+)"', drawing)) == {"currentColor"}
        assert min(map(float, re.findall(r'<text [^>]*font-size="([\d.]+)"', drawing))) >= 10.0


@pytest.mark.slow
def test_the_site_fetches_nothing_from_elsewhere(site):
    fetched = r'<(?:script|img|iframe)[^>]* src="\w*:?//[^"]*"|<link[^>]* href="\w*:?//[^"]*"'
    for page in site.glob("*.html"):
        assert re.findall(fetched, page.read_text(encoding="utf-8")) == [], page.name


@pytest.mark.slow
def test_equations_are_typeset_in_the_page(site):
    text = (site / "physics.html").read_text(encoding="utf-8")
    assert text.count('<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">') > 20
    assert "merror" not in text


@pytest.mark.slow
def test_the_reference_tells_every_function_of_the_library(site):
    text = (site / "reference.html").read_text(encoding="utf-8")
    assert [name for name in opml.__all__ if not re.search(rf'id="opml\.(api\.)?{name}"', text)] == []


SETTINGS = (REPOSITORY / "config" / "README.md").read_text(encoding="utf-8")


KEYS = (REPOSITORY / "config" / "keys.md").read_text(encoding="utf-8")


def test_every_setting_of_the_tables_has_a_sentence():
    rows = re.findall(r"^\| `([^`]+)` \| ([^|]*) \| ([^|]*) \|$", KEYS, re.MULTILINE)
    assert len(rows) > 120
    assert [key for key, meaning, values in rows if len(meaning.split()) < 2 or not values.strip()] == []


@pytest.mark.parametrize("sheet", ["stations", "rsos"])
def test_every_column_of_a_sheet_is_told(sheet):
    lines = (REPOSITORY / "config" / f"{sheet}.tsv").read_text(encoding="utf-8").splitlines()
    columns = next(line for line in lines if not line.startswith("#")).split("\t")
    text = re.search(rf"^\* `{sheet}.tsv`.*?\.$", SETTINGS, re.MULTILINE | re.DOTALL)[0]
    assert set(columns) <= set(re.findall(r"`(\w+)`", text))


@pytest.mark.parametrize("name", solar_activity.PACKAGED)
def test_the_packaged_activity_reaches_as_far_as_told(name):
    first, last = solar_activity.reach(name)
    assert re.search(rf"^\| `{name}` \| .* \| {first} \| {last} \|$", SETTINGS, re.MULTILINE), (first, last)


def test_every_folder_of_results_is_told():
    rules = "\n".join(
        path.read_text(encoding="utf-8") for path in (REPOSITORY / "workflow" / "rules").glob("*.smk")
    )
    page = (REPOSITORY / "docs" / "wildcards.md").read_text(encoding="utf-8")
    folders = {"logs", "benchmarks", *re.findall(r'product\(\s*f?"([a-z_\d]+)', rules)}
    assert folders > {"truth", "figs", "metrics", "study"}
    assert [name for name in sorted(folders) if not re.search(rf"`{name}[/.]", page)] == []


def test_the_floors_are_those_of_the_import_contract():
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
    contract = project["tool"]["importlinter"]["contracts"][0]
    floors = [set(re.findall(r"opml\.\w+", layer)) for layer in contract["layers"]]
    page = (REPOSITORY / "docs" / "architecture.md").read_text(encoding="utf-8")
    drawing = re.search(r"^## Floors$.*?```text\n(.*?)```", page, re.MULTILINE | re.DOTALL)[1]
    assert [
        set(re.findall(r"opml\.\w+", floor)) for floor in re.split(r"^ -+$", drawing, flags=re.M)
    ] == floors


@pytest.mark.parametrize("path", ["docs/architecture.md", "CONTRIBUTING.md"])
def test_what_describes_the_package_names_what_is_there(path):
    page = (REPOSITORY / path).read_text(encoding="utf-8")
    for name in sorted(set(re.findall(r"`(opml\.[\w.]+)`", page))):
        module, _, last = name.rpartition(".")
        try:
            importlib.import_module(name)
        except ModuleNotFoundError:
            assert hasattr(importlib.import_module(module), last), name


def test_modules_that_the_architecture_spells_short_are_there():
    page = (REPOSITORY / "docs" / "architecture.md").read_text(encoding="utf-8")
    modules = {path.stem for path in (REPOSITORY / "src" / "opml").rglob("*.py")}
    folders = {path.parent.name for path in (REPOSITORY / "src" / "opml").rglob("__init__.py")}
    prose = "\n".join(line for line in page.splitlines() if not line.startswith("|"))
    spelt = re.findall(r"`\.(\w+)`", page)
    spelt += re.findall(r"(?<=[(, ])`([a-z]+_[a-z_]+|[a-z]\w+(?=`[,)]))`", prose)
    assert set(spelt) - modules - folders - {"tracking"} == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(REPOSITORY).as_posix())
def test_lines_have_one_width(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if len(line) > 110 and not line.startswith("|")] == []
    assert [line for line in lines if line.lstrip().startswith("%")] == [], "the site takes it for a comment"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(REPOSITORY).as_posix())
def test_equations_are_written_as_the_site_reads_them(page):
    """Two digits are one numerator, and an index behind an accent stands below it."""
    text = page.read_text(encoding="utf-8")
    assert re.findall(r"\\t?frac\d.*|\\(?:hat|bar)(?: \w|\{\w\})_", text) == []


@pytest.mark.parametrize("note", sorted((REPOSITORY / "notes").glob("*.md")), ids=lambda note: note.stem)
def test_each_note_begins_with_what_it_is(note):
    title, blank, lead, *_ = note.read_text(encoding="utf-8").splitlines()
    assert (title[:2], blank) == ("# ", "")
    assert len(lead.split()) > 2
    assert lead[0].isupper()


def words(*pages):
    """Return how many words pages have, as `wc -w` counts them."""
    return sum(len(page.read_text(encoding="utf-8").split()) for page in pages)


def test_the_pages_are_short_enough():
    pages = [page for page in (REPOSITORY / "docs").glob("*.md") if page.name not in NOT_BY_HAND]
    assert words(*pages, REPOSITORY / "config" / "README.md") <= 24_900
    assert words(REPOSITORY / "CONTRIBUTING.md") <= 2_000
    assert words(REPOSITORY / "README.md") <= 450
