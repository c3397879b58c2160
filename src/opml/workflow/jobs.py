"""The frame of every job of the workflow: a log, metadata, errors in one line."""

import logging
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

import pandas as pd
from threadpoolctl import threadpool_limits

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.progress import remaining
from opml.base.provenance import settings_digest, settings_of_each
from opml.base.section import JobSettings
from opml.tables import Schema, read_table

SHOWN_EVERY = 30.0  # time after which a job that still runs shows its progress [s]

_log = logging.getLogger("opml")
_warnings = logging.getLogger("py.warnings")

TableKey = TypeVar("TableKey")


class _Common(JobSettings):
    """Settings of a job in the metadata of its tables; the seed of those that draw."""

    epoch: str
    seed: int | dict[str, int] | None = None  # one, or those by what they draw


class _LogFile(logging.FileHandler):
    """A log that goes without the lines that a full disk does not take; the job itself reports the disk."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Pass over a line that was not written."""

    def close(self) -> None:
        """Close the file, whether its last lines are written or not."""
        with suppress(OSError):
            super().close()


class _LongJob(logging.Handler):
    """Tells on the screen, every so often, how far a job is by the last line of its log."""

    def __init__(self, name: str) -> None:
        super().__init__(logging.INFO)
        self._job, self._began, self._last = name, time.monotonic(), "started"
        self._share = 0.0
        self._ended = threading.Event()
        self._teller = threading.Thread(target=self._tell, daemon=True)
        self._teller.start()

    def emit(self, record: logging.LogRecord) -> None:
        """Keep the last message, and the share of the work that was done by then."""
        self._last = record.getMessage()
        self._share = getattr(record, "share", self._share)

    def close(self) -> None:
        """End with the job."""
        self._ended.set()
        self._teller.join()
        super().close()

    def _tell(self) -> None:
        while not self._ended.wait(SHOWN_EVERY):
            print(f"opml: {self._job}: {self._last.strip()}, {self._time()}", file=sys.stderr, flush=True)

    def _time(self) -> str:
        passed = time.monotonic() - self._began
        left = f", {remaining(passed, self._share)}" if self._share else ""
        return f"{passed / 60.0:.1f} min so far{left}"


@contextmanager
def job(snakemake: Any) -> Iterator[dict[str, Any]]:
    """Run a script's body with its log open; yield the metadata of the tables that it writes.

    Progress, through the loggers below ``opml``, goes to the rule's log, its last line to stderr every
    SHOWN_EVERY. An `InputError` ends the job with
    one line there and on stderr and with exit code 1, any other error with its traceback. BLAS is held to one
    thread, as its sums depend on their number.
    """
    handlers = _open_log(snakemake.log)
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            _log.info("%s: started", snakemake.rule)
            yield _metadata(snakemake.params.settings)
            _log.info("%s: finished", snakemake.rule)
    except InputError as error:
        _log.error("%s", error)
        sys.exit(1)
    except Exception:
        _log.exception("%s: failed", snakemake.rule)
        sys.exit(1)
    finally:
        for handler in handlers:
            _log.removeHandler(handler)
            _warnings.removeHandler(handler)
            handler.close()


def metadata_of_each(settings: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the metadata of the tables of a job for several RSOs or learners, in the order of these.

    The metadata of each are those of a job for this one alone. So the bytes of a table do not depend on what
    was made with it.
    """
    return [_metadata(alone) for alone in settings_of_each(settings)]


def read_by_key(
    keys: Iterable[TableKey], paths: Iterable[FilePath], kind: str | Schema
) -> dict[TableKey, pd.DataFrame]:
    """Read a job's tables of one kind; return them by the key in a path's place.

    Raises InputError as `read_table` does, ValueError for another number of paths than of keys.
    """
    return {key: read_table(path, kind) for key, path in zip(keys, paths, strict=True)}


def progress(share: float) -> None:
    """Log how far a long job is, as a share from 0 to 1."""
    _log.info("%3.0f %% done", 100.0 * share, extra={"share": share})


def _open_log(paths: Any) -> list[logging.Handler]:
    screen = logging.StreamHandler(sys.stderr)
    screen.setLevel(logging.ERROR)
    screen.setFormatter(logging.Formatter("opml: %(message)s"))
    files = [_LogFile(path, mode="w", encoding="utf-8") for path in paths]
    for file in files:
        file.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    handlers: list[logging.Handler] = [screen, *files, _LongJob(str(paths[0]) if files else "job")]
    for handler in handlers:
        _log.addHandler(handler)
        _warnings.addHandler(handler)
    _log.setLevel(logging.INFO)
    logging.captureWarnings(True)
    return handlers


def _metadata(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the metadata of a table about its making; settings: of the rule's params."""
    common = _Common.model_validate(settings)
    return {
        "epoch": common.epoch,
        "time_scale": "SI seconds since epoch",
        "settings": settings_digest(settings),
        "version": __version__,
        **common.model_dump(include={"seed"}, exclude_unset=True),
    }
