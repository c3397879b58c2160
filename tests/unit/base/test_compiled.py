"""Compiled kernels are kept once for all clones of the same source."""

import runpy
from pathlib import Path

import numba
import pytest
from numba.core.codegen import JITCodeLibrary

from opml.base.compiled import SharedLocator, decorators, kernel_folder
from opml.base.errors import InputError
from opml.dynamics import attraction, ensemble, frames
from opml.learning.models import smo_kernels

KERNELS = {
    "block": ensemble.advance,
    "attraction": attraction._pull,
    "frames": frames._rotations,
    "smo_kernels": smo_kernels.descend,
}


@pytest.mark.parametrize("name", KERNELS)
def test_kernels_are_kept_by_their_source_not_by_its_path(name):
    folder = Path(KERNELS[name]._cache.cache_path)
    assert folder.parent == Path(numba.config.CACHE_DIR)
    assert folder.name == kernel_folder(KERNELS[name].py_func.__code__.co_filename)


def test_two_clones_share_a_folder_and_what_it_holds(tmp_path):
    text = Path(smo_kernels.__file__).read_bytes()
    for clone in ("one", "two"):
        (tmp_path / clone).mkdir()
        (tmp_path / clone / "kernel.py").write_bytes(text)
    one, two = (
        SharedLocator(smo_kernels.descend.py_func, str(tmp_path / clone / "kernel.py"))
        for clone in ("one", "two")
    )
    assert one.get_cache_path() == two.get_cache_path()
    assert one.get_source_stamp() == two.get_source_stamp()


@pytest.mark.parametrize(
    "changed",
    ["import numpy\nx = 2\n", "import opml.dynamics.kernels.drag\nx = 1\n"],
    ids=["other source", "other imports"],
)
def test_other_source_or_other_imports_have_a_folder_of_their_own(tmp_path, changed):
    (tmp_path / "kernel.py").write_text("import numpy\nx = 1\n")
    before = kernel_folder(tmp_path / "kernel.py")
    (tmp_path / "kernel.py").write_text(changed)
    assert kernel_folder(tmp_path / "kernel.py") != before


def test_kernels_become_machine_code_where_an_entry_links_them_alone(monkeypatch):
    names, translate = [], JITCodeLibrary._finalize_specific
    monkeypatch.setattr(JITCodeLibrary, "_finalize_specific", lambda x: names.append(x.name) or translate(x))
    compiled, _ = decorators()
    leaf = compiled(lambda x: x + 1.0)
    branch = compiled(lambda x: leaf(x) * leaf(x + 1.0))
    assert numba.njit(lambda x: branch(x) + leaf(x))(2.0) == 15.0
    assert len(set(names) - {"nrt"}) == 1


def test_no_folder_that_can_be_written_is_told_in_one_line(tmp_path, monkeypatch):
    no_folder = tmp_path / "__pycache__"  # beside the source, too
    no_folder.touch()
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(no_folder))
    monkeypatch.setenv("XDG_CACHE_HOME", str(no_folder))
    (tmp_path / "kernel.py").write_text("def same(x):\n    return x\n")
    _, entry = decorators()
    with pytest.raises(
        InputError, match=f"^{no_folder}: expected a folder for compiled kernels: set OPML_CACHE"
    ):
        entry(runpy.run_path(str(tmp_path / "kernel.py"))["same"])
