"""Two folders of results: what counts as a difference, what does not, and how it is told."""

import subprocess
import sys

import matplotlib.image
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from support import REPOSITORY

from validation import folders

TABLE = {
    "i": [0, 1, 2],
    "e_y": [1.0, np.nan, 3.0],
    "reason": ["", "decayed", ""],
    "keep": [True, False, True],
}
PIXELS = np.zeros((2, 3, 4), dtype=np.uint8)


def write(folder, table=TABLE, *, pixels=PIXELS, text="# Metrics\n", seed=42):
    """A small folder of results: a table, a figure in two formats, a text, a log and a benchmark."""
    for name in ("dataset/iss", "figs", "tables", "logs", "benchmarks"):
        (folder / name).mkdir(parents=True)
    arrow = pa.table(table).replace_schema_metadata({"seed": str(seed)})
    pq.write_table(arrow, folder / "dataset/iss/eglin.parquet")
    matplotlib.image.imsave(folder / "figs/one.png", pixels, metadata={"Software": str(seed)})
    (folder / "figs/one.pdf").write_bytes(b"%PDF-1.4")
    (folder / "tables/models.md").write_text(text)
    (folder / "logs/dataset.log").write_text(f"at {seed}")
    (folder / "benchmarks/dataset.tsv").write_text(f"s\n{seed}\n")
    return folder


@pytest.fixture
def before(tmp_path):
    return write(tmp_path / "before")


@pytest.fixture
def after(tmp_path):
    return lambda *given, **named: write(tmp_path / "after", *given, **named)


def test_metadata_logs_and_benchmarks_do_not_count(before, after):
    comparison = folders.compare(before, after(seed=43))
    assert comparison.agrees
    assert (comparison.same, comparison.different) == ({"tables": 1, "texts": 1, "figures": 2}, {})


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"e_y": [1.0, np.nan, 3.0 + 1e-15]}, "e_y: 1 of 3 rows differ, by up to 8.88e-16"),
        ({"e_y": [1.0, 2.0, 3.0]}, "e_y: 1 of 3 rows differ"),
        ({"e_y": [1.5, 2.0, 3.0]}, "e_y: 2 of 3 rows differ, by up to 0.5"),
        ({"i": [0, 1, 3]}, "i: 1 of 3 rows differ"),
        ({"reason": ["", "", ""]}, "reason: 1 of 3 rows differ"),
        ({"keep": [True, True, True]}, "keep: 1 of 3 rows differ"),
        ({"i": [0.0, 1.0, 2.0]}, "i: int64 before, double after"),
    ],
)
def test_a_column_that_differs_is_named(before, after, changed, told):
    comparison = folders.compare(before, after(TABLE | changed))
    assert not comparison.agrees
    assert comparison.differences == [f"dataset/iss/eglin.parquet: {told}"]
    assert comparison.different == {"tables": 1}


def test_pixels_and_bytes_count(before, after):
    pixels = PIXELS.copy()
    pixels[0, 1, 0] = 255
    folder = after(pixels=pixels, text="# Metrics!\n")
    (folder / "figs/one.pdf").write_bytes(b"%PDF-1.5")
    assert folders.compare(before, folder).differences == [
        "figs/one.pdf: other bytes (8 before, 8 after)",
        "figs/one.png: 1 of 6 pixels differ",
        "tables/models.md: other bytes (10 before, 11 after)",
    ]


@pytest.mark.parametrize("name", ["dataset/iss/eglin.parquet", "figs/one.png"])
def test_a_damaged_file_differs(before, after, name):
    folder = after()
    (folder / name).write_bytes((folder / name).read_bytes()[:20])
    (difference,) = folders.compare(before, folder).differences
    assert difference.startswith(f"{name}: cannot be read (")


def test_files_of_one_side_are_listed_and_must_not_be_lost(before, after):
    folder = after()
    (folder / "figs/two.pdf").write_bytes(b"%PDF-1.4")
    more = folders.compare(before, folder)
    assert more.agrees
    assert (more.only_before, more.only_after) == ([], ["figs/two.pdf"])
    less = folders.compare(folder, before)
    assert not less.agrees
    assert (less.only_before, less.only_after) == (["figs/two.pdf"], [])


def test_the_command_counts_lists_and_exits(before, after):
    folder = after(TABLE | {"i": [0, 1, 3]})
    command = [sys.executable, "-m", "validation.folders"]
    done = subprocess.run([*command, before, folder], capture_output=True, text=True, cwd=REPOSITORY)
    assert done.returncode == 1
    assert done.stdout == (
        "            same  different\n"
        "tables         0          1\n"
        "texts          1          0\n"
        "figures        2          0\n"
        "other          0          0\n"
        "\nDifferent:\n  dataset/iss/eglin.parquet: i: 1 of 3 rows differ\n"
    )
