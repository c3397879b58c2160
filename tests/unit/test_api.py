"""The library's face: each function's example, the documented chain, and defaults that are the paper's."""

import ast
import doctest
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import pandas as pd
import pytest
import sinking_histories
from support import REPOSITORY, paper_values

import opml
from opml import api
from opml.tables import LEARNING_VARIABLES

SETTINGS = paper_values()
STUDY = SETTINGS["study"]
FUNCTIONS = [
    node.name
    for node in ast.parse(Path(api.__file__).read_text(encoding="utf-8")).body
    if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the project's sheets and element sets, where examples may write."""
    shutil.copytree(REPOSITORY / "config", tmp_path / "config")
    sinking_histories.write(tmp_path / "sets.tle", range(101, 102), 49)
    monkeypatch.chdir(tmp_path)


def test_the_packages_sheets_are_read_from_any_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "eglin" in opml.read_stations("config/stations.tsv")
    assert "iss" in opml.read_rsos("config/rsos.tsv")


@pytest.mark.usefixtures("folder")
def test_each_function_has_an_example_that_holds():
    names = {"opml": opml, "Path": Path}
    runner = doctest.DocTestRunner()
    for function in FUNCTIONS:
        [example] = doctest.DocTestFinder(recurse=False).find(getattr(api, function), function, globs=names)
        assert example.examples, function
        example.globs = names
        assert runner.run(example, clear_globs=False).failed == 0, function


@pytest.mark.usefixtures("folder")
def test_the_documented_chain_runs():
    text = (REPOSITORY / "docs" / "library.md").read_text(encoding="utf-8")
    chain = re.search(r"```python\n(.*?)```", text, re.DOTALL)[1]
    names = {}
    exec(chain, names)
    assert 0 < names["left"] < 100


def test_the_documentation_lists_each_function():
    text = (REPOSITORY / "docs" / "reference.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\.\. autofunction:: (\w+)$", text, re.MULTILINE)) == sorted(FUNCTIONS)


def test_each_name_is_there_and_no_other():
    for name in opml.__all__:
        assert getattr(opml, name) is getattr(api, name)
    assert set(FUNCTIONS) <= set(opml.__all__) <= set(dir(opml))
    with pytest.raises(AttributeError, match="no attribute 'fly'"):
        _ = opml.fly


def test_the_import_alone_loads_nothing():
    script = "import opml, sys; sys.exit('numpy' in sys.modules or 'opml.api' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script]).returncode == 0


def test_a_prediction_loads_no_optimizer():
    modules = "opml.element_sets.prediction, opml.workflow.prediction_files"
    script = f"import sys, {modules}; sys.exit('scipy.optimize' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script]).returncode == 0


def test_defaults_are_those_of_the_settings():
    cleaning = STUDY["cleaning"]
    limits = {key: cleaning[key] for key in ("cd_min", "cd_max")}
    for model, ours in (("truth", opml.TRUTH), ("assumed", opml.ASSUMED)):
        settings = SETTINGS["force_models"][model]
        assert {**ours, "third_bodies": set(ours["third_bodies"])} == {
            **settings,
            "third_bodies": set(settings["third_bodies"]),
        }
    absent = {"reject_sigma": None, "suspect_sigma": None}
    assert SETTINGS["estimation"] | limits | absent == opml.ESTIMATION
    assert {**opml.CLEANING, "fence_days": list(opml.CLEANING["fence_days"])} == cleaning
    assert SETTINGS["learners"]["svr"] == opml.LEARNER
    assert list(api._SPAN_DAYS) == STUDY["span_days"]
    assert list(LEARNING_VARIABLES) == SETTINGS["learning"]["variables"]


def _coarse(degree):
    """As much of an environment as a force model's checks look at."""
    return SimpleNamespace(gravity_field=pd.DataFrame({"n": range(degree + 1)}))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: opml.learn(None, component="e_r"), "learn: component: expected e_x, .*, got e_r"),
        (
            lambda: opml.estimate(*[None] * 5, settings={"hours": 1}),
            "estimate: settings: expected window_hours, .*, got hours",
        ),
        (
            lambda: opml.dataset(
                opml.Catalogue(*[None] * 3, SimpleNamespace(gm=1.0), cleaning={"fences": 1})
            ),
            "dataset: settings: expected cd_min, .*, got fences",
        ),
        (
            lambda: opml.force_model(_coarse(4), degree=5),
            "force_model: degree, order: expected 0 <= order <= degree <= 4, got 5, 40",
        ),
        (
            lambda: opml.force_model(_coarse(4), degree=4, order=4, third_bodies=["vulcan"]),
            "force_model: third_bodies.0: expected 'sun', .*, got 'vulcan'",
        ),
    ],
)
def test_what_is_unknown_is_told_in_one_line(call, message):
    with pytest.raises(opml.InputError, match=message):
        call()


def test_the_look_of_figures_is_set_again_where_it_was_changed():
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        assert matplotlib.rcParams["axes.spines.top"]
        colors = opml.style()
        assert not matplotlib.rcParams["axes.spines.top"]
        assert len(set(colors.values())) == len(colors)
