"""Objects of a job: what is wrong with one is told of it, what is wrong with the disk ends the job."""

import errno
from datetime import date
from pathlib import Path
from types import SimpleNamespace

import pytest

from opml.base.errors import InputError
from opml.mornings import batch
from opml.mornings.batch import BatchSettings, ObjectSettings
from opml.mornings.outcomes import FAILED

ONE = ObjectSettings.model_construct(rso=None, options={})
DAY = date(2016, 10, 5)
OBJECTS = {"first": ONE, "second": ONE}
SETTINGS = BatchSettings.model_construct(
    days=Path("days"), batch="0", date=DAY, max_days=1.0, objects=OBJECTS
)


def outcomes(monkeypatch, reason):
    """What becomes of two objects, of which the first meets an error."""

    def met(name, *_):
        if name == "first":
            raise reason

    second = SimpleNamespace(outcomes={"second": {"object": "second"}})
    store = SimpleNamespace(
        done=lambda _: {name: [] for name in OBJECTS}, places=lambda _: {"second": second}
    )
    monkeypatch.setattr(batch.Surroundings, "read", lambda *_, **__: SimpleNamespace(sets=None))
    monkeypatch.setattr(batch, "Store", lambda *_: store)
    monkeypatch.setattr(batch, "_begin", met)
    monkeypatch.setattr(batch.days, "catch_up", lambda *_, **__: None)
    return batch.run(None, SETTINGS, metadata={})


@pytest.mark.parametrize("reason", [InputError("mine.tdm: rubbish"), OSError(errno.EACCES, "denied")])
def test_an_error_of_one_object_is_told_and_the_next_is_run(monkeypatch, reason):
    first, second = outcomes(monkeypatch, reason)
    assert first["verdict"] == FAILED
    assert second == {"object": "second"}


def test_a_full_disk_ends_the_job(monkeypatch):
    with pytest.raises(OSError, match="No space"):
        outcomes(monkeypatch, OSError(errno.ENOSPC, "No space left on device"))
