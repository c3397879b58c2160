"""Downloads with manners: a file is requested once in some hours, one try, and only data are kept.

CelesTrak's usage policy (2026-05): data change every two hours at most, who asks for the same again before
gets 403, and a program stops at any answer but 200 and shows it to its user.
"""

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import replacing, write_text
from opml.interop.orbit_arcs import excerpt

AGENT = f"opml-orbits/{__version__} (orbit prediction)"
_TIMEOUT = (10.0, 60.0)  # to connect, and between bytes [s]
_NOT_MODIFIED, _FINE = 304, 200


class NoAnswerError(InputError):
    """A server that gave no data: it cannot be reached, it refused, or was requested too recently."""


@dataclass(frozen=True)
class Download:
    """A file that a server has.

    name: of the file here; url: with its query; hours: during which it is requested once
    check: raises InputError for bytes that are none of it
    """

    name: str
    url: str
    hours: float
    check: Callable[[bytes], None]


def now() -> datetime:
    """Return the time, UTC."""
    return datetime.now(UTC)


class Downloads:
    """A folder of files as servers gave them last, with a record of the request of each."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._record = folder, folder / "asked.json"

    def requests(self) -> Mapping[str, Mapping[str, str]]:
        """Return by name when each file was requested (`at`), the answer, and `last_modified`."""
        if not self._record.exists():
            return {}
        return dict(json.loads(self._record.read_text(encoding="utf-8")))

    def path(self, name: str) -> Path:
        """Return where a file is, once it was fetched."""
        return self.folder / name

    def age(self, name: str) -> timedelta | None:
        """Return how long ago a file was fetched, or found unchanged; None for one that never was."""
        path = self.path(name)
        if not path.exists():
            return None
        return now() - datetime.fromtimestamp(path.stat().st_mtime, UTC)

    def renew(self, file: Download) -> bool:
        """Request a file unless it was requested recently; return whether its content is new.

        Raises NoAnswerError, with the server's words, where it gives no data: the last good file stays.
        """
        record = self.requests().get(file.name, {})
        if record and now() - datetime.fromisoformat(record["at"]) < timedelta(hours=file.hours):
            if record["answer"]:
                raise NoAnswerError(
                    f"{record['answer']}; asked at {record['at'][:16]}, once in {file.hours:g} h"
                )
            return False
        return self._ask(file, record.get("last_modified", ""))

    def _ask(self, file: Download, last_modified: str) -> bool:
        import requests  # a tenth of a second

        path = self.path(file.name)
        headers = {"User-Agent": AGENT}
        if last_modified and path.exists():
            headers["If-Modified-Since"] = last_modified
        try:
            answer = requests.get(file.url, headers=headers, timeout=_TIMEOUT, allow_redirects=False)
        except requests.RequestException as error:
            raise NoAnswerError(f"{file.url}: expected an answer, got {excerpt(str(error))}") from None
        if answer.status_code == _NOT_MODIFIED:
            self._note(file, "", last_modified)
            os.utime(path, (now().timestamp(),) * 2)
            return False
        if refusal := _refusal(answer.status_code, answer.content, file):
            self._note(file, refusal, last_modified)
            raise NoAnswerError(refusal)
        is_new = not path.exists() or path.read_bytes() != answer.content
        with replacing(path) as temporary:
            temporary.write_bytes(answer.content)
            os.utime(temporary, (now().timestamp(),) * 2)
        self._note(file, "", answer.headers.get("Last-Modified", ""))
        return is_new

    def _note(self, file: Download, answer: str, last_modified: str) -> None:
        entry = {"at": now().isoformat(), "url": file.url, "answer": answer, "last_modified": last_modified}
        write_text(self._record, json.dumps({**self.requests(), file.name: entry}, indent=1))


def _refusal(status: int, content: bytes, file: Download) -> str:
    """Return why an answer holds no data, in one line with its first words; '' for one that does."""
    words = excerpt(content[:400].decode("utf-8", "replace"))
    if status != _FINE:
        return f"{file.url}: expected an answer 200, got {status}: {words}"
    try:
        file.check(content)
    except InputError as error:
        return f"{error}: {words!r}: {file.url}"
    return ""
