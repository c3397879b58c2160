"""Tracks that radars really measured, from the measurements of messages to the `tracking` table.

A message names its stations and times as it likes. Here they are held against the stations of the sheet, the
run, and what an orbit can be, so that a wrong unit is told before anything is fitted to it.
"""

import re
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY, EARTH_GM, WGS84_A
from opml.base.errors import InputError
from opml.catalog.fit.three_positions import herrick_gibbs, smoothed, unturned
from opml.catalog.simulate.observing import place, site
from opml.catalog.simulate.tracking import QUANTITIES
from opml.orbits.sheets import LOWEST_PERIGEE, Station
from opml.tables import SCHEMAS

LONGEST_GAP = 300.0
"""Longest time between two measurements of one track [s]."""

BEYOND_LIMITS = 6.0
"""How far noise may take a measurement beyond what its station sees, in standard deviations."""

ENOUGH = 20
"""Measurements of which no angle is as large as a turn in radians by chance."""

_SHORTEST = 60.0
"""Shortest track whose velocity tells whether it is one of an orbit [s]."""

_ORBITAL = 0.2, 1.95
"""Squared speeds of an orbit, in those of a circular one at its height: eccentricities up to 0.8."""


def tracks(measurements: pd.DataFrame, stations: Sequence[Station]) -> pd.DataFrame:
    """The `tracking` table of what the stations measured; nothing is known of values without noise.

    measurements: as `interop.tdm.measurements` gives them; those of other stations are left out. A track is
    a run of measurements without a gap of more than LONGEST_GAP, of one TRACK_ID where there are any; tracks
    that overlap are one. Raises InputError, naming file and line, for what an orbit cannot be, or a station
    not see, and where nothing is left.
    """
    table = _checked(measurements, {station.name: station for station in stations})
    if table.empty:
        names = ", ".join(station.name for station in stations)
        raise InputError(f"{measurements['path'].iloc[0]}: expected measurements by {names}, got none")
    order = {station.name: k for k, station in enumerate(stations)}
    table = table.assign(order=table["station"].map(order)).sort_values(["t", "order"], ignore_index=True)
    table["track"] = _numbered(table)
    table[[f"{name}_true" for name in QUANTITIES]] = np.nan
    return table[SCHEMAS["tracking"].names]


def check(
    measurements: pd.DataFrame, stations: Mapping[str, Station], *, epoch: str, duration: float
) -> None:
    """Raise InputError, naming file and line, where no tracks could be made of measurements.

    stations: all that there are; duration: of the run [s]. A station is unknown, a time is outside of the
    run, a station measured twice at a time, or what it cannot see, or what is no orbit.
    """
    unknown = measurements[~_keys(measurements["station"]).isin(stations)]
    if not unknown.empty:
        raise _wrong(unknown, f"a station of {', '.join(stations)}", unknown["station"].iloc[0])
    t = measurements["t"]
    outside = (t < 0.0) | (t > duration)
    if outside.any():
        run = f"a time within the run, {epoch} and {duration / DAY:g} days"
        days = t[outside].iloc[0] / DAY
        raise _wrong(measurements[outside], run, f"one {days:+.2f} days from its beginning")
    _checked(measurements, stations)


def _checked(measurements: pd.DataFrame, stations: Mapping[str, Station]) -> pd.DataFrame:
    """The measurements of known stations, by the sheet's names, and seen to be ones of an orbit."""
    table = measurements.assign(station=_keys(measurements["station"]))
    table = table[table["station"].isin(stations)].reset_index(drop=True)
    if not table.empty:
        _check_once(table)
        _check_degrees(table)
        _check_limits(table, stations)
        _check_orbit(table, stations)
    return table


def _keys(names: pd.Series) -> pd.Series:
    """Names as a sheet may have them: DSS-14 is dss14 there."""
    found: pd.Series = names.map(lambda name: re.sub(r"[^a-z0-9]", "", name.lower()))
    return found


def _check_once(table: pd.DataFrame) -> None:
    again = table.duplicated(["station", "t"])
    if again.any():
        row = table[again].iloc[0]
        raise _wrong(table[again], f"one measurement by {row['station']} at a time", "a second one")


def _check_degrees(table: pd.DataFrame) -> None:
    """Raise InputError where all angles are as small as if they were in radians."""
    degrees = np.degrees(table[["azimuth", "elevation"]].to_numpy())
    if len(table) >= ENOUGH and np.all(np.abs(degrees) <= [2.0 * np.pi, 0.5 * np.pi]):
        expected = "angles in degrees"
        raise _wrong(table, expected, f"none beyond {degrees.max():.3g}, as if they were in radians")


def _check_limits(table: pd.DataFrame, stations: Mapping[str, Station]) -> None:
    """Raise InputError for the first measurement of what its station cannot see."""
    for name, rows in table.groupby("station", sort=False):
        one = stations[str(name)]
        elevation = one.min_elevation, one.max_elevation
        _check_within(rows, "elevation", elevation, one.sigma_elevation, "deg", np.degrees(1.0))
        _check_within(rows, "range", (0.0, one.max_range), one.sigma_range, "km", 1e-3)


def _check_within(
    rows: pd.DataFrame, name: str, limits: tuple[float, float], sigma: float, unit: str, scale: float
) -> None:
    """Raise InputError for the first row beyond limits; `scale` is from SI to the unit that is told."""
    beyond = rows[~rows[name].between(limits[0] - BEYOND_LIMITS * sigma, limits[1] + BEYOND_LIMITS * sigma)]
    if not beyond.empty:
        low, high, got = (scale * value for value in (*limits, beyond[name].iloc[0]))
        expected = f"{name} of {low:g} to {high:g} {unit}, as {rows['station'].iloc[0]} sees"
        raise _wrong(beyond, expected, f"{got:.6g}")


def _check_orbit(table: pd.DataFrame, stations: Mapping[str, Station]) -> None:
    """Raise InputError where places are too low for an orbit, or the usual speed is none."""
    places = _places(table, stations)
    height = np.linalg.norm(places, axis=1) - WGS84_A
    low = height < LOWEST_PERIGEE - _margins(table, stations)
    if low.any():
        expected = f"a place higher than {LOWEST_PERIGEE / 1e3:g} km"
        raise _wrong(table[low], expected, f"{height[low][0] / 1e3:.0f} km: are units and station right?")
    speeds = _speeds(table, places)
    if speeds and not _ORBITAL[0] < np.median(speeds) < _ORBITAL[1]:
        got = f"{np.sqrt(np.median(speeds)):.2f} times that of a circular one"
        raise _wrong(table, "the speed of an orbit", f"{got}: are ranges one-way, units and station right?")


def _places(table: pd.DataFrame, stations: Mapping[str, Station]) -> np.ndarray:
    """Places (n, 3) in ITRF [m] where the RSO was measured."""
    sites = {name: site(stations[name]) for name in table["station"].unique()}
    position, to_horizon = (np.array([sites[name][k] for name in table["station"]]) for k in (0, 1))
    return place(table[QUANTITIES].to_numpy(), position, to_horizon)


def _margins(table: pd.DataFrame, stations: Mapping[str, Station]) -> np.ndarray:
    """How far noise may take a place up or down (n,) [m]."""
    sigma = np.array([stations[name].sigma_elevation for name in table["station"]])
    return np.asarray(BEYOND_LIMITS * sigma * table["range"].to_numpy())


def _speeds(table: pd.DataFrame, places: np.ndarray) -> list[float]:
    """Squared speed of each long track of one station, in that of a circular orbit at its height."""
    found = []
    for _, rows in table.groupby(["station", _runs(table)]):
        rows = rows.sort_values("t")
        t = rows["t"].to_numpy()
        if len(t) >= 5 and t[-1] - t[0] >= _SHORTEST:
            t = t - t[0]
            times, three = smoothed(t, unturned(t, places[rows.index]))
            # By their times, as Gibbs's method would make an orbit of any three places.
            velocity = herrick_gibbs(three, times, EARTH_GM)
            found.append(float(velocity @ velocity * np.linalg.norm(three[1]) / EARTH_GM))
    return found


def _runs(table: pd.DataFrame) -> pd.Series:
    """Number of each row's run of one station's measurements without a long gap."""
    ordered = table.sort_values(["station", "t"])
    breaks = (ordered["t"].diff().abs() > LONGEST_GAP) | (ordered["station"] != ordered["station"].shift())
    return breaks.cumsum().reindex(table.index)


def _numbered(table: pd.DataFrame) -> np.ndarray:
    """Number (n,) of each row's track, of rows by time."""
    pieces = [
        (piece["t"].iloc[0], piece["t"].iloc[-1])
        for _, rows in table.groupby([table["path"].where(table["track_id"] != "", ""), "track_id"])
        for _, piece in rows.groupby((rows["t"].diff() > LONGEST_GAP).cumsum())
    ]
    begins, ends = np.array(sorted(pieces)).T
    latest = np.maximum.accumulate(ends)
    first = begins[np.append(True, begins[1:] > latest[:-1])]
    return np.asarray(np.searchsorted(first, table["t"].to_numpy(), side="right") - 1)


def _wrong(rows: pd.DataFrame, expected: str, got: str) -> InputError:
    """The error of the first of some rows."""
    row = rows.iloc[0]
    return InputError(f"{row['path']}: line {row['line']}: expected {expected}, got {got}")
