"""The package as others install it: a wheel that holds the workflow, and a project that is begun from it."""

import math
import os
import re
import shutil
import subprocess
import sys
import venv
from collections.abc import Iterator
from importlib.metadata import distribution, distributions
from pathlib import Path

import pytest
from data_server import as_csv, serving
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from project import ROOT, jobs

from opml.environment import solar_activity
from opml.interop.element_sets import tle
from opml.interop.element_sets.element_set import satellite

pytestmark = pytest.mark.slow
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs")
SOURCES = ("pyproject.toml", "LICENSE", "Snakefile", *PAGES, "src", "workflow", "config", "profiles")
# What the extra `workflow` brings cannot be imported.
LIBRARY = """
import sys
sys.modules |= dict.fromkeys(("matplotlib", "pygments", "snakemake"))
import opml
assert all(hasattr(opml, name) for name in opml.__all__)
print(opml.__file__)
"""


def run(*command, **options):
    """What a command prints, and that it ends well."""
    done = subprocess.run(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


def pip(*arguments):
    """Run pip without an index."""
    return run(sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments)


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder in which a wheel of this tree is installed, without what it depends on."""
    folder = tmp_path_factory.mktemp("wheel")
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, symlinks=True)
        else:
            shutil.copyfile(ROOT / name, folder / name)
    (folder / "workflow" / "schemas").mkdir(exist_ok=True)
    (folder / "workflow" / "schemas" / "config.schema.json").touch()  # as `make` writes for editors
    pip("wheel", "--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir", folder, folder)
    (wheel,) = folder.glob("*.whl")
    assert wheel.name.startswith("opml_orbits-")
    pip("install", "--no-deps", "--no-index", "--target", folder / "installed", wheel)
    return folder / "installed"


@pytest.fixture
def environment(installed):
    """Variables under which Python finds the installed package before this tree's."""
    return os.environ | {"PYTHONPATH": str(installed), "NO_COLOR": "1"}


def test_what_make_writes_for_editors_stays_out_of_the_wheel(installed):
    assert (installed / "opml" / "workflow" / "project" / "workflow" / "rules").is_dir()
    assert not (installed / "opml" / "workflow" / "project" / "workflow" / "schemas").exists()


def test_the_library_needs_nothing_of_the_workflow(installed, environment, tmp_path):
    found = run(sys.executable, "-c", LIBRARY, env=environment, cwd=tmp_path)
    assert found.strip() == str(installed / "opml" / "__init__.py")


def test_the_documentation_travels_in_the_wheel(installed, environment, tmp_path):
    pages = run(sys.executable, installed / "bin" / "opml", "docs", env=environment, cwd=tmp_path)
    folder = Path(pages.splitlines()[0].rpartition(" ")[2])
    assert folder == installed / "opml" / "manual" / "docs"
    for page in (ROOT / "docs").glob("*.md"):
        assert (folder / page.name).read_bytes() == page.read_bytes()
        for image in re.findall(r"\]\((images/[^)]+)", page.read_text(encoding="utf-8")):
            assert (folder / image).is_file()
    assert (folder / "notebook.ipynb").read_bytes() == (ROOT / "docs" / "notebook.ipynb").read_bytes()
    settings = run(
        sys.executable, installed / "bin" / "opml", "docs", "settings", env=environment, cwd=tmp_path
    )
    assert settings.startswith("# Settings\n")


def test_a_project_from_the_wheel_plans_its_study(installed, environment, tmp_path):
    told = run(sys.executable, installed / "bin" / "opml", "init", "new", env=environment, cwd=tmp_path)
    command, pages = told.splitlines()[-2:]
    assert pages == "opml docs howto"
    command = command.replace("-j2", "-n").split()
    plan = run(sys.executable, "-m", *command, env=environment, cwd=tmp_path / "new")
    assert jobs(plan)["truth"] == jobs(plan)["study_report"] == 1
    assert "results/mine/study.html" in plan


def brought(requirement: Requirement, known: set[tuple[str, str]]) -> Iterator[str]:
    """Names of the packages that a requirement brings, itself and its extras' among them."""
    name = canonicalize_name(requirement.name)
    for extra in ("", *sorted(requirement.extras)):
        if (name, extra) in known:
            continue
        known.add((name, extra))
        yield name
        for text in distribution(name).requires or []:
            needed = Requirement(text)
            if needed.marker is None or needed.marker.evaluate({"extra": extra}):
                yield from brought(needed, known)


@pytest.fixture(scope="module")
def python(installed, tmp_path_factory):
    """Python of an empty environment that has the wheel, and the packages of README's line alone."""
    folder = tmp_path_factory.mktemp("empty")
    venv.create(folder, with_pip=False, symlinks=True)
    (packages,) = folder.glob("lib/*/site-packages")
    (line,) = re.findall(r"pip install '(.+)'", README)
    names = {*brought(Requirement(line), set())}
    assert {"pymsis", "snakemake"} <= names < {canonicalize_name(one.name) for one in distributions()}
    here = [
        distribution(name).locate_file(part)
        for name in names - {"opml-orbits"}
        for part in {file.parts[0] for file in distribution(name).files or []} - {"..", "__pycache__"}
    ]
    for path in {*here, *(one for one in installed.iterdir() if one.name != "bin")}:
        (packages / path.name).symlink_to(path)
    return folder / "bin" / "python"


def test_what_readme_installs_runs_what_it_shows(python, tmp_path, monkeypatch):
    """The object is a geostationary one: no kernel is compiled for it."""
    lines = [line for day in range(3) for line in geostationary(day)]
    (tmp_path / "truth.sp3").write_text("\n".join(lines[-2:]) + "\n")
    shown = re.findall(r"^    opml ((?:predict|compare) .*?)(?: *#.*)?$", README, re.MULTILINE)
    assert len(shown) == 2
    with serving(monkeypatch, tmp_path / "data") as server:
        server.sets("CATNR=25544", as_csv(lines))
        weather = solar_activity.read_text(solar_activity.resolve("OBSERVED"))
        server.answers["/SpaceData/SW-Last5Years.csv"] = (200, weather.encode())
        for command in shown:
            told = run(python, "-m", "opml", *command.split(), cwd=tmp_path)
    assert "root mean square differences from 2026-01-0" in told
    assert {"iss.oem", "iss.html"} <= {path.name for path in tmp_path.iterdir()}


def geostationary(day):
    """Lines of a set of the object 25544 on a day of January 2026."""
    motion = 2.0 * math.pi * 1.0027 / 1440.0
    made = satellite(f"2026-01-0{day + 4}T02:00:00", [motion, 2e-4, 0.001, 1.0, 1.0, 1.0 + 0.017 * day, 0.0])
    return tle.lines(made, 25544)
