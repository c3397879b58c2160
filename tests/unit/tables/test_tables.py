"""Tables: what is written comes back, and what is damaged is noticed."""

import io
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from support import refusal

from opml import tables
from opml.base.errors import InputError
from opml.learning.models import learners
from opml.tables import SCHEMAS, listing, parquet, read_metadata, read_runs, read_table, write_table

TABLES = SCHEMAS | {schema.name: schema for schema in learners.schemas()}
METADATA = {"epoch": "2016-09-28T12:09:45", "seed": 42, "gm": {"sun": 1.32712440041279419e20}}


def example(name, rows=5):
    """A table of any schema, each column with values of its own."""
    values = {
        "float64": lambda k: np.linspace(-1.0, 1.0, rows) * 10.0**k,
        "int64": lambda k: np.arange(rows) + k,
        "bool": lambda k: np.arange(rows) % 2 == k % 2,
        "string": lambda k: [f"text {k} {row}" if row else "" for row in range(rows)],
    }
    columns = TABLES[name].columns
    return pd.DataFrame({column.name: values[column.dtype](k) for k, column in enumerate(columns)})


@pytest.fixture
def truth(tmp_path):
    path = tmp_path / "truth.parquet"
    write_table(path, example("truth"), "truth", metadata=METADATA)
    return path


@pytest.mark.parametrize("name", TABLES)
def test_every_table_comes_back_as_written(name, tmp_path):
    path = tmp_path / "folder" / "table.parquet"
    frame = example(name)
    write_table(path, frame.sample(frac=1.0, axis=1, random_state=1), TABLES[name], metadata=METADATA)
    pd.testing.assert_frame_equal(read_table(path, TABLES[name]), frame, check_column_type=False)
    assert read_metadata(path) == METADATA


@pytest.mark.parametrize("name", TABLES)
def test_an_empty_table_keeps_its_columns(name, tmp_path):
    write_table(tmp_path / "t", example(name, rows=0), TABLES[name], metadata={})
    assert list(read_table(tmp_path / "t", TABLES[name]).columns) == TABLES[name].names


def test_optional_columns_come_back_where_they_are(tmp_path):
    plain, wide = example("tracking"), example("tracking").assign(range_rate=1.5, two_way=True)
    for name, frame in (("plain", plain), ("wide", wide)):
        write_table(tmp_path / name, frame, "tracking", metadata={})
        pd.testing.assert_frame_equal(read_table(tmp_path / name, "tracking"), frame, check_column_type=False)
        assert [len(run) for run in read_runs(tmp_path / name, "tracking", "station")] == [1] * len(frame)
        assert list(next(read_runs(tmp_path / name, "tracking", "station"))) == list(frame)
    with pytest.raises(ValueError, match="columns missing or not in the schema: \\['rate'\\]"):
        write_table(tmp_path / "t", plain.assign(rate=1.0), "tracking", metadata={})


def test_not_a_number_stays_one(tmp_path):
    frame = example("truth")
    frame.loc[2, ["x", "vz"]] = [np.nan, -np.inf]
    write_table(tmp_path / "t", frame, "truth", metadata={})
    pd.testing.assert_frame_equal(read_table(tmp_path / "t", "truth"), frame)


def test_columns_carry_unit_frame_and_meaning(truth):
    field = pq.read_schema(truth).field("vx")
    assert {key: field.metadata[key] for key in (b"unit", b"frame", b"meaning")} == {
        b"unit": b"m/s",
        b"frame": b"GCRF",
        b"meaning": b"true state, vx",
    }


def test_same_table_same_bytes(truth, tmp_path):
    write_table(tmp_path / "again", example("truth"), "truth", metadata=dict(reversed(METADATA.items())))
    assert (tmp_path / "again").read_bytes() == truth.read_bytes()


@pytest.mark.parametrize("rows_at_once", [1, 3, 4, 100])
def test_runs_are_whole_wherever_a_batch_ends(rows_at_once, tmp_path, monkeypatch):
    frame = example("corrected", rows=10).assign(i=[2, 2, 2, 4, 4, 4, 4, 4, 5, 2])
    write_table(tmp_path / "f.parquet", frame, "corrected", metadata=METADATA)
    monkeypatch.setattr(parquet, "_BATCH_ROWS", rows_at_once)
    runs = list(read_runs(tmp_path / "f.parquet", "corrected", "i"))
    assert [(run["i"].iloc[0], len(run)) for run in runs] == [(2, 3), (4, 5), (5, 1), (2, 1)]
    pd.testing.assert_frame_equal(pd.concat(runs, ignore_index=True), frame, check_column_type=False)


def test_runs_of_a_damaged_table_are_refused(truth):
    truth.write_bytes(truth.read_bytes()[:-20])
    assert "truth.parquet: damaged" in refusal(list, read_runs(truth, "truth", "t"))


def test_a_wrong_table_is_refused_and_leaves_nothing(tmp_path):
    with pytest.raises(ValueError, match="vz"):
        write_table(tmp_path / "t", example("truth").drop(columns="vz"), "truth", metadata={})
    with pytest.raises((TypeError, ValueError)):
        write_table(tmp_path / "t", example("truth").assign(vz="fast"), "truth", metadata={})
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_keeps_the_old_table(truth, monkeypatch):
    before = truth.read_bytes()

    def fail(table, path, **options):
        Path(path).write_bytes(b"PAR1 half")
        raise OSError("disk full")

    monkeypatch.setattr(parquet.pq, "write_table", fail)
    with pytest.raises(OSError, match="disk full"):
        write_table(truth, example("truth", rows=9), "truth", metadata={})
    assert truth.read_bytes() == before
    assert list(truth.parent.iterdir()) == [truth]


def test_missing_file_is_named(tmp_path):
    assert "nothing.parquet: no such file" in refusal(read_table, tmp_path / "nothing.parquet", "truth")


def test_missing_column_is_named(truth):
    pq.write_table(pq.read_table(truth).drop_columns(["vy"]), truth)
    expected = "truth.parquet: vy: column of table truth is missing: another version of opml wrote it"
    assert expected in refusal(read_table, truth, "truth")


def test_column_of_another_type_is_named(truth):
    frame = pq.read_table(truth).to_pandas().astype({"vy": "float32"})
    frame.to_parquet(truth)
    assert "truth.parquet: vy: expected float64, got float" in refusal(read_table, truth, "truth")


def test_another_tools_table_is_not_taken_for_ours(truth):
    example("truth").to_parquet(truth)
    assert "not written by opml" in refusal(read_table, truth, "truth")


@pytest.mark.parametrize("kept", [0, 3, 200, 0.5, -1])
def test_truncated_file_is_noticed(truth, kept):
    content = truth.read_bytes()
    truth.write_bytes(content[: int(kept * len(content)) if isinstance(kept, float) else kept])
    assert "truth.parquet: damaged" in refusal(read_table, truth, "truth")


def test_a_flipped_bit_is_noticed_and_told_in_one_line(tmp_path):
    path = tmp_path / "table.parquet"
    write_table(path, example("corrected", rows=2), "corrected", metadata=METADATA)
    content = path.read_bytes()
    for place in [*range(100), *range(100, len(content), 9)]:
        damaged = bytearray(content)
        damaged[place] ^= 1 << place % 8
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"^[^\n]+$") as raised:
            read_table(path, "corrected")
        assert str(raised.value).startswith(str(path))


def test_a_flipped_bit_of_the_footer_is_noticed_where_only_the_metadata_are_read(tmp_path):
    path = tmp_path / "table.parquet"
    write_table(path, example("corrected", rows=2), "corrected", metadata=METADATA)
    content = path.read_bytes()
    footer = range(len(content) - 8 - int.from_bytes(content[-8:-4], "little"), len(content))
    for place in footer[::11]:
        damaged = bytearray(content)
        damaged[place] ^= 1 << place % 8
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="damaged"):
            read_metadata(path)


def test_model_schema_follows_the_variables(tmp_path):
    schema = learners.schema({"kind": "svr", "variables": ["duration", "gap"]})
    frame = pd.DataFrame({"dual_coef": [1.0], "duration": [0.5], "gap": [-0.5]})
    write_table(tmp_path / "t", frame, schema, metadata={"variables": ["duration", "gap"]})
    pd.testing.assert_frame_equal(read_table(tmp_path / "t", schema), frame, check_column_type=False)


FORMULAS = ["=1+1", "+cmd|' /C calc'!A1", "-2+3", "-2,3+1", "@SUM(A1)", "\t=1"]
PLAIN = ["", "-5", "-33.4,-70.6,500", "+1.5e-3", "-.5", "ISS (ZARYA)", "a=b", "2 - 1", "'quoted"]


def test_no_cell_of_a_csv_is_a_formula():
    frame = pd.DataFrame({"name": FORMULAS + PLAIN, "e_y": -1.5})
    written = io.StringIO()
    tables.comma_separated(frame, written)
    read = pd.read_csv(io.StringIO(written.getvalue(), newline=""), keep_default_na=False, dtype=str)
    assert read["name"].tolist() == [f"'{one}" for one in FORMULAS] + PLAIN
    assert set(read["e_y"]) == {"-1.5"}


def test_a_long_entry_of_the_metadata_is_cut_in_the_listing(tmp_path):
    """An array of thousands of numbers would push the columns off the screen."""
    metadata = METADATA | {"outlook": list(range(5000)), "card": "short"}
    write_table(tmp_path / "t", example("truth"), "truth", metadata=metadata)
    lines = listing.head(tmp_path / "t").splitlines()
    assert "card: short" in lines
    (long,) = [line for line in lines if line.startswith("outlook: ")]
    assert len(long) < 1100
    assert long.endswith(f"... ({len(json.dumps(list(range(5000))))} characters)")
