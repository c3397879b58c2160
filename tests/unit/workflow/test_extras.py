"""What the workflow leaves out where a package of an extra is missing."""

import importlib.util
import tomllib

import pytest
from support import REPOSITORY

from opml.workflow import extras

PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.mark.parametrize("spec", [None, importlib.util.spec_from_loader("plotly", loader=None)])
def test_pages_to_explore_need_plotly(spec, monkeypatch):
    monkeypatch.setattr(extras, "find_spec", {"plotly": spec}.get)
    assert extras.can_explore() is (spec is not None)


def test_the_note_names_the_extra_that_brings_plotly():
    (extra,) = (name for name in PROJECT["optional-dependencies"] if f"[{name}]" in extras.NO_EXPLORE)
    assert [package for package in PROJECT["optional-dependencies"][extra] if package.startswith("plotly")]
