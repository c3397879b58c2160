"""Histories of element sets from Space-Track, by the package `spacetrack` and the user's own account.

What was published of an object on a day is asked for once, as Space-Track's rules want it: the days that are
here are noted in `downloads/histories.json`. Objects that lack the same days are asked for together.
"""

import json
import os
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlparse

from opml.base.errors import InputError
from opml.base.files import data_folder, write_text
from opml.base.progress import Progress, counted
from opml.fetch.downloads import NoAnswerError, now
from opml.fetch.public_data import Query, numbers_of
from opml.interop import formats
from opml.interop.orbit_arcs import excerpt

if TYPE_CHECKING:
    from spacetrack import SpaceTrackClient

_ADDRESS = "https://www.space-track.org/"
_TOGETHER = 100  # objects in a request: their numbers stand in its address
_USER, _PASSWORD = "SPACETRACK_USER", "SPACETRACK_PASSWORD"

Span = tuple[date, date]  # first day, and the day after the last


def renew(queries: Iterable[Query], since: date, *, say: Progress) -> None:
    """Fetch the sets of objects that were published from a day on and before today, as far as not here.

    Those of a name or a group are the ones of its last download from CelesTrak. Raises InputError without the
    package or an account, NoAnswerError at the first answer without sets.
    """
    try:
        from spacetrack import SpaceTrackClient
    except ImportError:
        package = "the package spacetrack, got none: pip install 'opml-orbits[spacetrack]'"
        raise InputError(f"--since: expected {package}") from None
    address = os.environ.get("OPML_SPACETRACK", _ADDRESS)
    with SpaceTrackClient(*_account(address), base_url=address, cache_path=_downloads()) as client:
        for query in queries:
            for span, numbers in _missing(numbers_of(query), (since, now().date())):
                count = _renew_span(client, query, numbers, span)
                objects = f" of {counted(len(numbers), 'object')}" if query.kind != "number" else ""
                days = f"published from {span[0]} to {span[1]}: Space-Track"
                say(f"{query.value}: {counted(count, 'set')}{objects}, {days}")


def _account(address: str) -> tuple[str, str]:
    """Return user and password, of the environment or of netrc."""
    from requests.utils import get_netrc_auth

    user, password = os.environ.get(_USER), os.environ.get(_PASSWORD)
    account = (user, password) if user and password else get_netrc_auth(address)
    if account is None:
        host = urlparse(address).hostname
        raise InputError(f"--since: expected {_USER} and {_PASSWORD} set, or {host} in ~/.netrc, got neither")
    return account


def _renew_span(client: "SpaceTrackClient", query: Query, numbers: Sequence[str], span: Span) -> int:
    """Keep what was published of objects in a span as a file of the query's history; return how many sets."""
    from httpx2 import HTTPError
    from spacetrack import AuthenticationError
    from spacetrack.operators import inclusive_range

    asked = {"norad_cat_id": numbers, "creation_date": inclusive_range(*span), "orderby": "creation_date"}
    try:
        text = client.gp_history(**asked, format="json")
        sets = json.loads(text)
    except AuthenticationError:
        raise NoAnswerError(
            "Space-Track: expected an account that it knows, got a login that failed"
        ) from None
    except (HTTPError, ValueError) as error:
        raise NoAnswerError(f"Space-Track: expected element sets, got {excerpt(str(error))}") from None
    if sets:
        formats.of("Space-Track", text.encode(), formats.ELEMENTS)
        write_text(query.folder / f"{span[0]}--{span[1]}--{numbers[0]}.json", text)
    _note(numbers, span)
    return len(sets)


def _missing(numbers: Iterable[str], wanted: Span) -> Iterator[tuple[Span, list[str]]]:
    """Yield the days to ask for, so that those wanted and those known are one span, each with its objects."""
    known, lacking = _spans(), defaultdict(list)
    for number in numbers:
        first, last = known.get(number, (wanted[1], wanted[1]))
        for span in ((wanted[0], first), (last, wanted[1])):
            if span[0] < span[1]:
                lacking[span].append(number)
    for span, objects in lacking.items():
        for begin in range(0, len(objects), _TOGETHER):
            yield span, objects[begin : begin + _TOGETHER]


def _downloads() -> Path:
    return data_folder() / "downloads"


def _spans() -> dict[str, Span]:
    """Return by number of the object the days that were asked for."""
    path = _downloads() / "histories.json"
    texts = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return {
        number: (date.fromisoformat(first), date.fromisoformat(last))
        for number, (first, last) in texts.items()
    }


def _note(numbers: Iterable[str], span: Span) -> None:
    spans = _spans()
    for number in numbers:
        first, last = spans.get(number, span)
        spans[number] = min(first, span[0]), max(last, span[1])
    write_text(_downloads() / "histories.json", json.dumps(spans, indent=1, default=str))
