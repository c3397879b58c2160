"""The documentation: links lead somewhere, what it lists is what there is, and its site builds."""

import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import opml
from opml.environment import solar_activity
from opml.study.settings.schema import read_schema

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"\]\((?!\w+:|#)([^)\s#]+)")
PAGES = [
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "config" / "README.md",
    ROOT / "src" / "opml" / "data" / "README.md",
    *(ROOT / "docs").glob("*.md"),
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_between_files_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    assert [link for link in LINK.findall(text) if not (page.parent / link).exists()] == []


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built without a warning."""
    if importlib.util.find_spec("sphinx") is None:
        pytest.skip("Sphinx is not installed: make docs")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-d", str(folder / "doctrees")]
    done = subprocess.run([*command, "docs", str(folder / "html")], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "html"


def test_every_page_is_in_the_site(site):
    assert {page.stem for page in site.glob("*.html")} >= {page.stem for page in (ROOT / "docs").glob("*.md")}


def test_what_the_readme_links_to_is_a_page(site):
    first = (site / "index.html").read_text(encoding="utf-8")
    assert 'href="install.html"' in first
    assert 'href="contributing.html"' in first
    assert 'href="settings.html"' in first
    assert "README.md" not in re.findall(r'href="([^"]+)"', first)


def test_the_site_fetches_nothing_from_elsewhere(site):
    fetched = r'<(?:script|img|iframe)[^>]* src="\w*:?//[^"]*"|<link[^>]* href="\w*:?//[^"]*"'
    for page in site.glob("*.html"):
        assert re.findall(fetched, page.read_text(encoding="utf-8")) == [], page.name


def test_equations_are_typeset_in_the_page(site):
    text = (site / "physics.html").read_text(encoding="utf-8")
    assert text.count('<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">') > 20
    assert "merror" not in text


def test_the_reference_tells_every_function_of_the_library(site):
    text = (site / "reference.html").read_text(encoding="utf-8")
    assert [name for name in opml.__all__ if not re.search(rf'id="opml\.(api\.)?{name}"', text)] == []


SETTINGS = (ROOT / "config" / "README.md").read_text(encoding="utf-8")
SCHEMA = read_schema(ROOT / "workflow" / "schemas" / "config.schema.yaml")
ANY = "<>"


def tabulated():
    """Key -> the names between backticks in its row, of the tables of the run and of the study."""
    text = re.search(r"^## The run$.*?(?=^## Solar)", SETTINGS, re.MULTILINE | re.DOTALL)[0]
    rows = re.findall(r"^\| (`[^|]*) \| ([^|]*) \|", text, re.MULTILINE)
    return {
        tuple(re.sub(r"<\w+>", ANY, key).split(".")): set(re.findall(r"`([^`]+)`", meaning))
        for keys, meaning in rows
        for key in re.findall(r"`([^`]+)`", keys)
    }


def below(node):
    """The schema's nodes below one, by name; those of any name are below ANY."""
    while "$ref" in node:
        node = SCHEMA["$defs"][node["$ref"].rpartition("/")[2]]
    more = node.get("additionalProperties")
    return node.get("properties", {}) | ({ANY: more} if isinstance(more, dict) else {})


def test_every_setting_of_the_tables_stands_in_the_schema():
    for key in tabulated():
        node = SCHEMA
        for part in key:
            assert part in below(node), ".".join(key)
            node = below(node)[part]


def untold(node, key, table):
    """Keys of the schema below a node that no table has and that no row names of the mapping they are in."""
    entry = {"rso", "stations", "learner", "component"} if key[:1] == ("study",) else set()
    for name, child in below(node).items():
        path = (*key, name)
        if any(other[: len(path)] == path for other in table):
            yield from untold(child, path, table)
        elif name not in {ANY} | entry | table.get(key, set()):
            yield ".".join(path)


def test_every_setting_of_the_schema_stands_in_a_table():
    assert list(untold(SCHEMA, (), tabulated())) == []
    assert tabulated()["study", "defaults"] == {"rso", "stations", "learner", "component"}


@pytest.mark.parametrize("sheet", ["stations", "rsos"])
def test_every_column_of_a_sheet_is_told(sheet):
    lines = (ROOT / "config" / f"{sheet}.tsv").read_text(encoding="utf-8").splitlines()
    columns = next(line for line in lines if not line.startswith("#")).split("\t")
    text = re.search(rf"^\* `{sheet}.tsv`.*?\.$", SETTINGS, re.MULTILINE | re.DOTALL)[0]
    assert set(columns) <= set(re.findall(r"`(\w+)`", text))


@pytest.mark.parametrize("name", solar_activity.PACKAGED)
def test_the_packaged_activity_reaches_as_far_as_told(name):
    first, last = solar_activity.reach(name)
    assert re.search(rf"^\| `{name}` \| .* \| {first} \| {last} \|$", SETTINGS, re.MULTILINE), (first, last)


def test_every_folder_of_results_is_told():
    rules = "\n".join(
        path.read_text(encoding="utf-8") for path in (ROOT / "workflow" / "rules").glob("*.smk")
    )
    page = (ROOT / "docs" / "wildcards.md").read_text(encoding="utf-8")
    folders = set(re.findall(r"\{RESULTS\}/([a-z]+)/", rules)) | set(
        re.findall(r'documents\(\s*"([a-z]+)', rules)
    )
    assert [name for name in sorted(folders) if not re.search(rf"`{name}[/.]", page)] == []


def test_the_floors_are_those_of_the_import_contract():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contract = project["tool"]["importlinter"]["contracts"][0]
    floors = [set(re.findall(r"opml\.\w+", layer)) for layer in contract["layers"]]
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    drawing = re.search(r"^## Floors$.*?```text\n(.*?)```", page, re.MULTILINE | re.DOTALL)[1]
    assert [
        set(re.findall(r"opml\.\w+", floor)) for floor in re.split(r"^ -+$", drawing, flags=re.M)
    ] == floors


def test_what_the_architecture_names_is_there():
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for name in sorted(set(re.findall(r"`(opml\.[\w.]+)`", page))):
        module, _, last = name.rpartition(".")
        try:
            importlib.import_module(name)
        except ModuleNotFoundError:
            assert hasattr(importlib.import_module(module), last), name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_lines_have_one_width(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if len(line) > 110 and not line.startswith("|")] == []
