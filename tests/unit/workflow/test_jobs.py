"""The frame around every job: log, metadata, and how errors end it."""

import errno
import logging
import re
import time
from types import SimpleNamespace

import pandas as pd
import pytest
from threadpoolctl import threadpool_info

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import replacing
from opml.base.provenance import settings_digest
from opml.tables import TRUTH_GROUPS, write_table
from opml.workflow import jobs
from opml.workflow.jobs import job, metadata_of_each, progress, read_by_key

SETTINGS = {"epoch": "2016-09-28T12:09:45", "seed": 42, "step_s": 20}


@pytest.fixture
def snakemake(tmp_path):
    return SimpleNamespace(
        rule="truth", log=[str(tmp_path / "job.log")], threads=1, params=SimpleNamespace(settings=SETTINGS)
    )


def log(snakemake):
    with open(snakemake.log[0]) as file:
        return file.read()


@pytest.mark.parametrize("seed", [42, {"noise": 42, "split": 7}], ids=["one", "by what they draw"])
def test_metadata_tells_how_a_table_was_made(snakemake, seed):
    snakemake.params.settings = settings = SETTINGS | {"seed": seed}
    with job(snakemake) as metadata:
        pass
    assert metadata == {
        "epoch": "2016-09-28T12:09:45",
        "time_scale": "SI seconds since epoch",
        "settings": settings_digest(settings),
        "seed": seed,
        "version": __version__,
    }


def test_a_table_does_not_tell_what_was_made_with_it(snakemake):
    each = metadata_of_each(SETTINGS | {"rsos": ["iss", "lares"]})
    for rso, told in zip(["iss", "lares"], each, strict=True):
        snakemake.params.settings = SETTINGS | {"rso": rso}
        with job(snakemake) as alone:
            assert told == alone


def test_a_table_does_not_tell_which_learners_were_replayed_with_its_own(snakemake):
    learners = [{"kind": "none"}, {"kind": "refitted"}]
    for learner, told in zip(learners, metadata_of_each(SETTINGS | {"learners": learners}), strict=True):
        snakemake.params.settings = SETTINGS | {"learners": [learner]}
        with job(snakemake) as alone:
            assert told == alone


def test_progress_and_warnings_go_to_the_log_alone(snakemake, capfd):
    with job(snakemake):
        progress(0.25)
        logging.getLogger("opml.catalog").info("fitted 3 tracks")
        logging.getLogger("py.warnings").warning("flat kernel")  # where logging.captureWarnings sends them
    for text in ("started", "25 % done", "fitted 3 tracks", "flat kernel", "finished"):
        assert text in log(snakemake)
    assert capfd.readouterr().err == ""


def test_a_long_job_tells_how_far_it_is(snakemake, capfd, monkeypatch):
    monkeypatch.setattr(jobs, "SHOWN_EVERY", 0.02)
    with job(snakemake):
        progress(0.25)
        deadline, told = time.monotonic() + 5.0, ""
        while "25 % done" not in told and time.monotonic() < deadline:
            time.sleep(0.01)
            told += capfd.readouterr().err
    assert re.search(f"opml: {snakemake.log[0]}: 25 % done, 0.0 min so far, \\d+ s left\n", told)
    capfd.readouterr()
    time.sleep(0.05)
    assert capfd.readouterr().err == ""


def test_input_error_is_one_line_and_exit_code_1(snakemake, capfd):
    with pytest.raises(SystemExit) as ended, job(snakemake):
        raise InputError("truth.parquet: vy: column\n is missing")
    assert ended.value.code == 1
    assert capfd.readouterr().err == "opml: truth.parquet: vy: column is missing\n"
    assert "ERROR truth.parquet: vy: column is missing" in log(snakemake)
    assert "Traceback" not in log(snakemake)


def test_any_other_error_keeps_its_traceback(snakemake, capfd):
    with pytest.raises(SystemExit) as ended, job(snakemake):
        raise ZeroDivisionError("a bug")
    assert ended.value.code == 1
    assert "ZeroDivisionError: a bug" in log(snakemake)
    assert "Traceback" in capfd.readouterr().err


def test_linear_algebra_has_one_thread(snakemake):
    # Sums of BLAS depend on the number of threads, and results must not.
    with job(snakemake):
        inside = [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]
    assert inside
    assert set(inside) == {1}


def test_handlers_are_gone_afterwards(snakemake):
    before = list(logging.getLogger("opml").handlers)
    with job(snakemake):
        pass
    assert logging.getLogger("opml").handlers == before


def test_tables_stand_under_the_keys_of_their_places(tmp_path):
    paths = [tmp_path / "first.parquet", tmp_path / "second.parquet"]
    for path, rso in zip(paths, ("iss", "lares"), strict=True):
        write_table(path, pd.DataFrame({"rso": [rso]}), TRUTH_GROUPS, metadata={})
    groups = read_by_key([("a", 1), ("b", 2)], paths, TRUTH_GROUPS)
    assert {key: table["rso"].tolist() for key, table in groups.items()} == {
        ("a", 1): ["iss"],
        ("b", 2): ["lares"],
    }
    with pytest.raises(ValueError, match="longer"):
        read_by_key(["a"], paths, TRUTH_GROUPS)


def refuse(*_):
    """What the system does where the disk is full."""
    raise OSError(errno.ENOSPC, "no space, says a library")


def write_on_a_full_disk(path):
    with replacing(path) as temporary:
        temporary.write_text("half")
        refuse()


def test_a_full_disk_is_told_in_one_line(snakemake, capfd, tmp_path, monkeypatch):
    monkeypatch.setattr(logging.FileHandler, "flush", refuse)
    table = tmp_path / "table.parquet"
    with pytest.raises(SystemExit), job(snakemake):
        write_on_a_full_disk(table)
    told = f"opml: {table}: expected a file that can be written, got No space left on device\n"
    assert capfd.readouterr().err == told
    assert [path.name for path in tmp_path.iterdir()] == ["job.log"]


def test_an_error_that_is_none_of_the_disks_stays_what_it_is(tmp_path):
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "table.parquet"):
        (tmp_path / "other").read_bytes()
