"""Conversion of epochs: UTC text and elapsed SI seconds to Julian dates in TAI, TT, TDB and UTC.

A Julian date is a pair (day, fraction) whose sum is the date, ERFA's two-part convention, which keeps
nanoseconds over a run. Leap seconds are pyerfa's.
"""

import math
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, date, datetime, timedelta
from functools import lru_cache

import erfa
import numpy as np
from numpy.typing import ArrayLike

from opml.base.constants import DAY
from opml.base.errors import InputError

Time = str | date | np.datetime64  # UTC, of a day when it begins
JulianDate = tuple[np.ndarray, np.ndarray]  # whole days and their fractions; the date is the sum
MJD_ZERO = 2400000.5  # Julian date at which the modified Julian days begin

_SHORT_TEXTS = {10: "T00:00:00", 13: ":00:00", 16: ":00"}  # what days, hours and minutes lack, by length
_UTC_TEXT = re.compile(r"(\d{4})-(\d\d)-(\d\d)T(\d\d):(\d\d):(\d\d(?:\.\d+)?)", re.ASCII)


def parse(epoch: str) -> tuple[int, int, int, int, int, float]:
    """Split UTC text 'YYYY-MM-DDThh:mm:ss[.s]' into year, month, day, hour, minute, second.

    Raises InputError where the text is malformed or no such instant exists.
    """
    match = _UTC_TEXT.fullmatch(epoch) if isinstance(epoch, str) else None
    if match is None:
        raise InputError(f"epoch: expected UTC text like 2016-09-28T12:09:45, got {epoch!r}")
    *whole, second = match.groups()
    year, month, day, hour, minute = map(int, whole)
    fields = (year, month, day, hour, minute, float(second))
    try:
        with strict_erfa():
            erfa.dtf2d("UTC", *fields)
    except (erfa.ErfaError, erfa.ErfaWarning) as reason:
        raise InputError(f"epoch: expected an instant that exists, got {epoch!r} ({reason})") from None
    return fields


def tai(epoch: str, t: ArrayLike) -> JulianDate:
    """Return the TAI Julian date of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    day, fraction = _tai(epoch)
    elapsed_days = np.asarray(t, dtype=float) / DAY
    return np.full_like(elapsed_days, day), fraction + elapsed_days


@lru_cache(maxsize=4096)
def _tai(epoch: str) -> tuple[float, float]:
    """Return the TAI Julian date of an epoch, which callers ask for over and over."""
    fields = parse(epoch)
    with strict_erfa():
        day, fraction = erfa.utctai(*erfa.dtf2d("UTC", *fields))
    return float(day), float(fraction)


def tt(epoch: str, t: ArrayLike) -> JulianDate:
    """Return the TT Julian date of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    day, fraction = erfa.taitt(*tai(epoch, t))
    return day, fraction


def tdb(epoch: str, t: ArrayLike) -> JulianDate:
    """Return the TDB Julian date, at the geocentre, of `epoch` + `t` SI seconds.

    TDB - TT is the series of Fairhead & Bretagnon 1990 as in ERFA's dtdb.
    Raises InputError on a malformed epoch.
    """
    day, fraction = tt(epoch, t)
    # At the geocentre the series' site terms vanish, whatever the universal time and longitude.
    with strict_erfa():
        difference = erfa.dtdb(day, fraction, 0.0, 0.0, 0.0, 0.0)
    day, fraction = erfa.tttdb(day, fraction, difference)
    return day, fraction


def utc(epoch: str, t: ArrayLike) -> JulianDate:
    """Return the UTC (quasi-)Julian date of `epoch` + `t` SI seconds. Raises InputError as `tai` does."""
    with strict_erfa():
        day, fraction = erfa.taiutc(*tai(epoch, t))
    return day, fraction


def mjd(text: str) -> float:
    """Return the modified Julian day of UTC text. Raises InputError for a malformed one."""
    day, fraction = utc(text, 0.0)
    return float((day - MJD_ZERO) + fraction)


def seconds_between(epoch: str, later: str) -> float:
    """Return the SI seconds from `epoch` to `later`, both UTC text, leap seconds included.

    Raises InputError on a malformed text.
    """
    (day, fraction), (later_day, later_fraction) = tai(epoch, 0.0), tai(later, 0.0)
    # Rounded to a nanosecond, so that whole seconds come out whole.
    return round(float((later_day - day) + (later_fraction - fraction)) * DAY, 9)


def seconds_to(epoch: str, time: Time) -> np.ndarray:
    """Return the SI seconds (1,) from an epoch to a time as `instant` takes it.

    Raises InputError on a malformed text, and for what is no time.
    """
    return np.array([seconds_between(epoch, instant(time))])


def instant(time: Time) -> str:
    """Return a time as `parse` has it: a day when it begins, a text without its Z and with a T for a blank.

    Raises InputError for what is no time.
    """
    if isinstance(time, datetime):
        aware = time if time.tzinfo else time.replace(tzinfo=UTC)
        time = aware.astimezone(UTC).replace(tzinfo=None)
    text = time.isoformat() if isinstance(time, date) else time
    if isinstance(time, np.datetime64) and not np.isnat(time):
        text = str(time.astype("M8[ns]"))
    if not isinstance(text, str):
        raise InputError(f"time: expected UTC text, a datetime or numpy.datetime64, got {time!r}")
    text = text.strip().removesuffix("Z").replace(" ", "T")
    whole = text + _SHORT_TEXTS.get(len(text), "")
    try:
        parse(whole)
    except InputError as reason:
        raise InputError(str(reason).replace("epoch", "date", 1).replace(whole, text)) from None
    return whole


def days_of_year(epoch: str, duration_s: float) -> tuple[float, np.ndarray]:
    """Return the start of the epoch's day, and the day of the year of each calendar day of a run.

    The start is the UTC midnight before the epoch [s since `epoch`], zero or negative. Days of the year are
    int64, 1 is January 1, and go on beyond the end of the run. A leap second inside the run moves later
    midnights by 1 s, which is left out. Raises InputError on a malformed epoch.
    """
    year, month, day, *_ = parse(epoch)
    first = date(year, month, day)
    midnight = seconds_between(epoch, f"{first.isoformat()}T00:00:00")
    days = math.ceil((duration_s - midnight) / DAY) + 1
    numbers = [(first + timedelta(days=k)).timetuple().tm_yday for k in range(days)]
    return midnight, np.array(numbers, dtype=np.int64)


def leap_seconds(earlier: ArrayLike, later: ArrayLike) -> np.ndarray:
    """Return the leap seconds (n,) from times to later ones, modified Julian days (UTC)."""
    days, behind_tai = _leap_seconds()
    before, behind = (behind_tai[np.searchsorted(days, t, side="right")] for t in (earlier, later))
    return np.asarray(behind - before)


@lru_cache(maxsize=1)
def _leap_seconds() -> tuple[np.ndarray, np.ndarray]:
    """Return the modified Julian days (n,) of changes of UTC, and TAI - UTC (n + 1,) before and after [s]."""
    table = erfa.leap_seconds.get()
    _, days = erfa.cal2jd(table["year"], table["month"], 1)
    return days, np.append(0.0, table["tai_utc"])


def calendar(mjd: float) -> str:
    """Return the calendar date 'YYYY-MM-DD' of a modified Julian day number."""
    return (date(1858, 11, 17) + timedelta(days=math.floor(mjd))).isoformat()


def calendar_day(epoch: str, t: float) -> str:
    """Return the calendar date (UTC) of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    return calendar(float(sum(utc(epoch, t))) - MJD_ZERO)


@contextmanager
def strict_erfa() -> Iterator[None]:
    """Raise ERFA's warnings as errors, except for years whose leap seconds are not announced yet."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", erfa.ErfaWarning)
        warnings.filterwarnings("ignore", r'.*yielded \d+ of "dubious year', erfa.ErfaWarning)
        yield
