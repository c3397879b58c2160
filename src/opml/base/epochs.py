"""Epochs: UTC text and elapsed SI seconds as Julian dates in the scales that the physics asks for.

A Julian date is a pair (day, fraction) whose sum is the date, which keeps nanoseconds over a run
(the two-part convention of ERFA). Leap seconds are those that pyerfa carries.
"""

import math
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import date, timedelta

import erfa
import numpy as np
from numpy.typing import ArrayLike

from opml.base.constants import DAY
from opml.base.errors import InputError

JulianDate = tuple[np.ndarray, np.ndarray]

MJD_ZERO = 2400000.5
"""Julian date at which the modified Julian days begin."""

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
    """TAI Julian date of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    fields = parse(epoch)
    with strict_erfa():
        day, fraction = erfa.utctai(*erfa.dtf2d("UTC", *fields))
    elapsed_days = np.asarray(t, dtype=float) / DAY
    return np.full_like(elapsed_days, day), fraction + elapsed_days


def tt(epoch: str, t: ArrayLike) -> JulianDate:
    """TT Julian date of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    date_tt: JulianDate = erfa.taitt(*tai(epoch, t))
    return date_tt


def tdb(epoch: str, t: ArrayLike) -> JulianDate:
    """TDB Julian date, at the geocentre, of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch.

    TDB - TT is the series of Fairhead & Bretagnon 1990 as in ERFA's dtdb.
    """
    day, fraction = tt(epoch, t)
    # At the geocentre the series' site terms vanish, whatever the universal time and longitude.
    with strict_erfa():
        difference = erfa.dtdb(day, fraction, 0.0, 0.0, 0.0, 0.0)
    date_tdb: JulianDate = erfa.tttdb(day, fraction, difference)
    return date_tdb


def utc(epoch: str, t: ArrayLike) -> JulianDate:
    """UTC (quasi-)Julian date of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    with strict_erfa():
        date_utc: JulianDate = erfa.taiutc(*tai(epoch, t))
    return date_utc


def elapsed(epoch: str, later: str) -> float:
    """SI seconds from `epoch` to `later`, both UTC text, leap seconds counted.

    Raises InputError where either is malformed.
    """
    (day, fraction), (later_day, later_fraction) = tai(epoch, 0.0), tai(later, 0.0)
    # Rounded to a nanosecond, so that whole seconds come out whole.
    return round(float((later_day - day) + (later_fraction - fraction)) * DAY, 9)


def days_of_year(epoch: str, duration_s: float) -> tuple[float, np.ndarray]:
    """Calendar days of a run: where they start and their number in the year.

    Returns the seconds from `epoch` to the UTC midnight that starts its day (zero or negative), and for
    that day and each one after it, beyond the end of the run, the day of the year (1 is January 1), int64.
    A leap second inside the run moves later midnights by 1 s, which this leaves out.
    Raises InputError on a malformed epoch.
    """
    year, month, day, *_ = parse(epoch)
    first = date(year, month, day)
    midnight = elapsed(epoch, f"{first.isoformat()}T00:00:00")
    days = math.ceil((duration_s - midnight) / DAY) + 1
    numbers = [(first + timedelta(days=k)).timetuple().tm_yday for k in range(days)]
    return midnight, np.array(numbers, dtype=np.int64)


def calendar(mjd: float) -> str:
    """Calendar date 'YYYY-MM-DD' of a modified Julian day number."""
    return (date(1858, 11, 17) + timedelta(days=math.floor(mjd))).isoformat()


def calendar_day(epoch: str, t: float) -> str:
    """Calendar date (UTC) of `epoch` + `t` SI seconds. Raises InputError on a malformed epoch."""
    return calendar(float(sum(utc(epoch, t))) - MJD_ZERO)


@contextmanager
def strict_erfa() -> Iterator[None]:
    """ERFA's warnings raised as errors, but for years whose leap seconds are not announced yet."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", erfa.ErfaWarning)
        warnings.filterwarnings("ignore", r'.*yielded \d+ of "dubious year', erfa.ErfaWarning)
        yield
