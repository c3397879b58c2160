"""Objects of a job: what is wrong with one is told of it, what is wrong with the disk ends the job."""

import errno
from datetime import date
from pathlib import Path

import pytest

from opml.base.errors import InputError
from opml.mornings import batch
from opml.mornings.batch import BatchSettings, ObjectSettings
from opml.mornings.outcomes import FAILED

ONE = ObjectSettings.model_construct(rso=None, taking={})
SETTINGS = BatchSettings.model_construct(
    days=Path("days"), date=date(2016, 10, 5), objects={"first": ONE, "second": ONE}
)


def outcomes(monkeypatch, reason):
    """What becomes of two objects, of which the first meets an error."""

    def met(folder, *_, **__):
        if folder.rso == "first":
            raise reason

    monkeypatch.setattr(batch.Surroundings, "read", lambda *_: None)
    monkeypatch.setattr(batch, "_catch_up", met)
    monkeypatch.setattr(batch.days, "read_outcome", lambda path: {"object": path.parent.name})
    return batch.run(None, SETTINGS, metadata={})


@pytest.mark.parametrize("reason", [InputError("mine.tdm: rubbish"), OSError(errno.EACCES, "denied")])
def test_an_error_of_one_object_is_told_and_the_next_is_run(monkeypatch, reason):
    first, second = outcomes(monkeypatch, reason)
    assert first["verdict"] == FAILED
    assert second == {"object": "second"}


def test_a_full_disk_ends_the_job(monkeypatch):
    with pytest.raises(OSError, match="No space"):
        outcomes(monkeypatch, OSError(errno.ENOSPC, "No space left on device"))
