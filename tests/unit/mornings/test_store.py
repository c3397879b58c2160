"""The folder of days: objects of a batch in the same files, each counted once it is over."""

import weakref
from datetime import date, timedelta

import numpy as np
import pandas as pd
import pytest
from support import refusal

from opml.base.errors import InputError
from opml.mornings.calendar import HORIZON
from opml.mornings.days import failed
from opml.mornings.kept import batch_day
from opml.mornings.kept.batch_day import PATHS, MorningMark
from opml.mornings.kept.store import Store
from opml.mornings.records import Paths, Records
from opml.tables import SCHEMAS, paths_schema

DAY = date(2016, 10, 5)
NAMES = ("first", "second")
METADATA = {"epoch": "2016-09-28T12:09:45", "settings": "all"}


def filled(schema, count, value, **more):
    """Rows of a table whose numbers are all the same."""
    values = {"bool": True, "int64": int(value), "float64": value, "string": "text"}
    columns = {column.name: [values[column.dtype]] * count for column in schema.columns}
    return pd.DataFrame(columns | more)


def finished(name, value, *, models=("fit96",), day=DAY):
    """A morning of an object whose numbers are all the same."""
    tables = [filled(SCHEMAS[table], 2, value) for table in Records.TABLES]
    paths = [Paths(filled(paths_schema(models), 3, value))] if models else []
    records = Records(*tables, paths=paths)
    mark = MorningMark("digest", {"eglin": "here"}, list(models))
    return records, failed(name, day, "good", "why"), mark


def write(folder, made, *, batch="0", day=DAY):
    Store(folder, batch, NAMES).write(day, made, metadata=METADATA)


def same(folder, name, morning, *, batch="0", day=DAY):
    """Whether an object's morning is kept as it was made."""
    place, (records, outcome, mark) = Store(folder, batch, NAMES).places(day)[name], morning
    for table, made in records.tables.items():
        pd.testing.assert_frame_equal(place.rows(table, name).reset_index(drop=True), made)
    for found, made in zip(place.paths(name), records.paths, strict=True):
        pd.testing.assert_frame_equal(found.table, made.table)
    return place.outcomes[name] == outcome and place.marks[name] == mark


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


MORNINGS = {
    "first": finished("first", 1.0, models=("sgp4", "density")),
    "second": finished("second", 2.0, models=("fit96", "sgp4")),
}


def test_each_object_has_its_own_rows_columns_and_models(tmp_path):
    write(tmp_path, MORNINGS)
    assert all(same(tmp_path, name, MORNINGS[name]) for name in NAMES)
    place = Store(tmp_path, "0", NAMES).places(DAY)["second"]
    assert place.paths("second")[0].models == ["fit96", "sgp4"]


def test_an_object_that_is_added_later_leaves_the_same_bytes(tmp_path):
    write(tmp_path / "once", MORNINGS)
    for name in reversed(NAMES):
        write(tmp_path / "twice", {name: MORNINGS[name]})
    assert contents(tmp_path / "twice") == contents(tmp_path / "once")


def test_rows_of_a_job_that_was_killed_do_not_count(tmp_path):
    write(tmp_path / "before", {"first": MORNINGS["first"]})
    write(tmp_path / "after", MORNINGS)
    place, later = (tmp_path / folder / DAY.isoformat() / "batch_0" for folder in ("before", "after"))
    for name in ("judged.parquet", "outcomes.json.gz"):
        (place / name).write_bytes((later / name).read_bytes())
    store = Store(tmp_path / "before", "0", NAMES)
    assert store.done(DAY) == {"first": [DAY], "second": []}
    assert same(tmp_path / "before", "first", MORNINGS["first"])
    store.write(DAY, {"second": MORNINGS["second"]}, metadata=METADATA)
    assert contents(tmp_path / "before") == contents(tmp_path / "after")


def test_an_object_is_found_in_the_batch_that_it_was_in(tmp_path):
    write(tmp_path, {"first": MORNINGS["first"]}, batch="3")
    write(tmp_path, {"second": MORNINGS["second"]})
    assert all(same(tmp_path, name, MORNINGS[name], batch="7") for name in NAMES)


def test_the_newest_mornings_count(tmp_path):
    days = [DAY + timedelta(days=k) for k in range(HORIZON + 2)]
    for day in days:
        write(tmp_path, {"first": finished("first", 1.0, models=(), day=day)}, day=day)
    assert Store(tmp_path, "0", NAMES).done(days[-2]) == {"first": days[1:-1], "second": []}


def test_a_late_morning_reads_as_many_tables_as_any_whatever_the_number_of_objects(tmp_path, monkeypatch):
    days = [DAY + timedelta(days=k) for k in range(HORIZON + 10)]
    for day in days:
        write(tmp_path, {name: finished(name, 1.0, models=(), day=day) for name in NAMES}, day=day)
    read, read_table = [], batch_day.read_table
    monkeypatch.setattr(batch_day, "read_table", lambda *asked: read.append(asked[0]) or read_table(*asked))
    counts = []
    for last in (days[HORIZON - 1], days[-1]):
        store = Store(tmp_path, "0", NAMES)
        past = [store.records(name, done, since=last) for name, done in store.done(last).items()]
        assert [len(one.issued) for one in past] == [2 * HORIZON] * len(NAMES)
        counts.append(len(read))
    assert counts == [3 * HORIZON, 6 * HORIZON]


@pytest.fixture
def week(tmp_path):
    """Three mornings of the first object; the second has the first of them alone."""
    for k in range(3):
        made = {name: finished(name, k) for name in NAMES[: 2 - bool(k)]}
        write(tmp_path, made, day=DAY + timedelta(days=k))
    return tmp_path, DAY + timedelta(days=2)


def test_ephemerides_go_when_no_object_needs_them(week):
    folder, last = week
    store = Store(folder, "0", NAMES)
    store.drop_paths(last, until=last)
    there = [(folder / f"2016-10-0{k}" / "batch_0" / PATHS).exists() for k in (5, 6, 7)]
    assert there == [True, False, True]
    assert len(store.records("first", [DAY, last], since=DAY).paths) == 2
    told = refusal(store.records, "first", [DAY, DAY + timedelta(days=1), last], since=DAY)
    assert told.startswith(f"{folder / '2016-10-06' / 'batch_0' / PATHS}: expected ephemerides of first")
    write(folder, {"second": finished("second", 1)}, day=DAY + timedelta(days=1))
    place = Store(folder, "0", NAMES).places(DAY + timedelta(days=1))["first"]
    assert place.marks["first"].models == ["fit96"]
    assert not place.paths("first")


def test_records_are_of_all_mornings(week):
    folder, last = week
    records = Store(folder, "0", NAMES).records("first", [DAY, last], since=last)
    np.testing.assert_array_equal(records.issued["morning"], [0.0, 0.0, 2.0, 2.0])
    assert [paths.made_at for paths in records.paths] == [2.0]


def test_what_was_read_is_let_go(week):
    folder, last = week
    store = Store(folder, "0", NAMES)
    issued = store.records("first", [DAY, last], since=last).issued
    place = weakref.ref(store.places(last)["first"])
    store.let_go()
    assert place() is None
    pd.testing.assert_frame_equal(store.records("first", [DAY, last], since=last).issued, issued)


def test_what_opml_did_not_write_is_told(tmp_path):
    write(tmp_path, MORNINGS)
    path = tmp_path / DAY.isoformat() / "batch_0" / "done.json"
    for text in ("half", "[]", '{"first": {}}'):
        path.write_text(text)
        with pytest.raises(InputError, match=f"^{path}: expected what opml wrote"):
            Store(tmp_path, "0", NAMES).done(DAY)
