"""Histories of element sets from Space-Track, by the package `spacetrack` and the user's own account.

What was published of an object on a day is asked for once, as Space-Track's rules want it: the days that are
here are noted in `downloads/histories.json`.
"""

import json
import os
from collections.abc import Iterable
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlparse

from opml.base.errors import InputError
from opml.base.files import data_folder, replacing
from opml.fetch.downloads import NoAnswerError, now
from opml.fetch.public_data import Query, Say
from opml.interop import formats
from opml.interop.orbit_arcs import excerpt

if TYPE_CHECKING:
    from spacetrack import SpaceTrackClient

_ADDRESS = "https://www.space-track.org/"
_USER, _PASSWORD = "SPACETRACK_USER", "SPACETRACK_PASSWORD"

Span = tuple[date, date]  # first day, and the day after the last


def renew(numbers: Iterable[str], since: date, *, say: Say) -> None:
    """Fetch the sets of objects that were published from a day on and before today, as far as not here.

    Raises InputError without the package or an account, NoAnswerError at the first answer without sets.
    """
    try:
        from spacetrack import SpaceTrackClient
    except ImportError:
        package = "the package spacetrack, got none: pip install 'opml-orbits[spacetrack]'"
        raise InputError(f"--since: expected {package}") from None
    address = os.environ.get("OPML_SPACETRACK", _ADDRESS)
    with SpaceTrackClient(*_account(address), base_url=address, cache_path=_downloads()) as client:
        for number in numbers:
            for span in _missing(_spans().get(number), (since, now().date())):
                count = _renew_span(client, number, span)
                say(f"{number}: {count} sets, published from {span[0]} to {span[1]}: Space-Track")


def _account(address: str) -> tuple[str, str]:
    """Return user and password, of the environment or of netrc."""
    from requests.utils import get_netrc_auth

    user, password = os.environ.get(_USER), os.environ.get(_PASSWORD)
    account = (user, password) if user and password else get_netrc_auth(address)
    if account is None:
        host = urlparse(address).hostname
        raise InputError(f"--since: expected {_USER} and {_PASSWORD} set, or {host} in ~/.netrc, got neither")
    return account


def _renew_span(client: "SpaceTrackClient", number: str, span: Span) -> int:
    """Keep what was published in a span as a file of the object's history; return how many sets."""
    from httpx2 import HTTPError
    from spacetrack import AuthenticationError
    from spacetrack.operators import inclusive_range

    asked = {"norad_cat_id": number, "creation_date": inclusive_range(*span), "orderby": "creation_date"}
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
        with replacing(Query.of(number).folder / f"{span[0]}--{span[1]}.json") as temporary:
            temporary.write_text(text, encoding="utf-8")
    _note(number, span)
    return len(sets)


def _missing(known: Span | None, wanted: Span) -> list[Span]:
    """Return the days to ask for, so that those wanted and those known are one span."""
    spans = [wanted] if known is None else [(wanted[0], known[0]), (known[1], wanted[1])]
    return [span for span in spans if span[0] < span[1]]


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


def _note(number: str, span: Span) -> None:
    spans = _spans()
    first, last = spans.get(number, span)
    spans[number] = min(first, span[0]), max(last, span[1])
    with replacing(_downloads() / "histories.json") as temporary:
        temporary.write_text(json.dumps(spans, indent=1, default=str), encoding="utf-8")
