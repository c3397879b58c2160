"""Tracks that stations really measured, from the measurements of messages to the `tracking` table.

A message names its stations and times as it likes. Here they are compared with the stations of the sheet, the
run, and what an orbit can be, so that a wrong unit is an error before anything is fitted to it.
"""

import re
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY, EARTH_GM, WGS84_A
from opml.base.errors import InputError
from opml.catalog.fit import refraction
from opml.catalog.fit.first.three_positions import herrick_gibbs, smoothed, unturned
from opml.catalog.simulate.observing import ANGLES, OBSERVABLES, QUANTITIES, measured_by, place, site
from opml.orbits.sheets import LOWEST_PERIGEE, Station
from opml.tables import SCHEMAS

LONGEST_GAP = 300.0  # longest time between two measurements of one track [s]

BEYOND_LIMITS = 6.0
"""Largest excess of a measurement over the limits of its station, in standard deviations."""

ENOUGH = 20  # measurements of which no angle is as large as a turn in radians by chance
_SHORTEST = 60.0  # shortest track whose velocity shows whether it belongs to an orbit [s]
_CLOSE = 0.1  # part of the usual step between measurements within which a station does not measure again

_ORBITAL = 0.2, 1.95
"""Squared speeds of an orbit, in those of a circular orbit at its height: eccentricities up to 0.8."""


def tracks(measurements: pd.DataFrame, stations: Sequence[Station]) -> pd.DataFrame:
    """Return the `tracking` table of the stations' measurements; values without noise are NaN.

    measurements: as `interop.tdm.measurements` returns them; those of other stations are left out

    A track is a run of measurements without a gap of more than LONGEST_GAP, of one TRACK_ID where there are
    any; tracks that overlap are one. What a station has no sigma of, counts as not
    measured. Air is taken off what its station has in a raw state and no file in a corrected one.

    Raises InputError, naming file and line, for what an orbit cannot be, or a station not see, and
    where nothing is left.
    """
    table = _checked(measurements, {station.name: station for station in stations})
    if table.empty:
        names = ", ".join(station.name for station in stations)
        raise InputError(f"{measurements['path'].iloc[0]}: expected measurements by {names}, got none")
    order = {station.name: k for k, station in enumerate(stations)}
    table = _without_air(table, {station.name: station for station in stations})
    table = table.assign(order=table["station"].map(order)).sort_values(["t", "order"], ignore_index=True)
    table["track"] = _numbered(table)
    given = [name for name in OBSERVABLES if name in QUANTITIES or table[name].notna().any()]
    table[[f"{name}_true" for name in given]] = np.nan
    kept = {*given, *(f"{name}_true" for name in given), "two_way"} & set(table.columns)
    return table[SCHEMAS["tracking"].among(kept).names]


def check(
    measurements: pd.DataFrame, stations: Mapping[str, Station], *, epoch: str, duration: float
) -> None:
    """Raise InputError, naming file and line, where no tracks can be made of measurements.

    stations: all that there are, by name
    duration: of the run [s]

    The reasons are an unknown station, a time outside of the run, a station that measured twice at a time or
    has a copy among its segments, and measurements that the station cannot see or no orbit can have.
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
    table = measurements.assign(station=_keys(measurements["station"]))
    table = table[table["station"].isin(stations)].reset_index(drop=True)
    if not table.empty:
        table = _joined(_weighed(table, stations))
        _check_once(table)
        _check_degrees(table)
        _check_limits(table, stations)
        _check_orbit(table, stations)
    return table


def _weighed(table: pd.DataFrame, stations: Mapping[str, Station]) -> pd.DataFrame:
    """Return the rows of what stations have a sigma of; raise InputError for one that all are without."""
    table = table.reindex(columns=[*table.columns, *(name for name in OBSERVABLES if name not in table)])
    measured_at = table[OBSERVABLES].notna()
    weighed = measured_at.copy()
    for name, rows in table.groupby("station", sort=False):
        names = measured_by(stations[str(name)])
        weighed.loc[rows.index] &= [observable in names for observable in OBSERVABLES]
        if not weighed.loc[rows.index].to_numpy().any():
            got = [observable for observable in OBSERVABLES if measured_at.loc[rows.index, observable].any()]
            raise _wrong(rows, f"{' or '.join(names)}, of which {name} has a sigma", " and ".join(got))
    table[OBSERVABLES] = table[OBSERVABLES].where(weighed)
    return table[weighed.any(axis=1)].reset_index(drop=True)


def _joined(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row of those of a station at one time that measure different things."""
    at = table.groupby(["station", "t"], sort=False)
    complements = (at[OBSERVABLES].transform("count") <= 1).all(axis=1)
    if not (complements & table.duplicated(["station", "t"])).any():
        return table
    both = table[complements].groupby(["station", "t"], sort=False, as_index=False).first()
    return pd.concat([table[~complements], both], ignore_index=True)


def _without_air(table: pd.DataFrame, stations: Mapping[str, Station]) -> pd.DataFrame:
    """Return measurements without what air did to those of stations that keep it.

    Raises InputError for ranges without the elevations that say how much air there is.
    """
    parts = []
    for (name, _), rows in table.groupby(["station", _runs(table)], sort=False):
        ordered = rows.sort_values("t")
        through = np.where(ordered["corrected"], 0.0, 1.0)
        by_air = _by_air(ordered, stations[str(name)])
        parts.append(ordered.assign(**{key: ordered[key] - through * off for key, off in by_air.items()}))
    return pd.concat(parts, ignore_index=True)


def _by_air(rows: pd.DataFrame, station: Station) -> dict[str, np.ndarray]:
    """Return what air adds to a pass of a station, by observable."""
    by_air, elevation = {}, rows["elevation"].to_numpy()
    if station.refraction:
        is_radio = station.sigma_range is not None
        by_air["elevation"] = refraction.bending(elevation, station.altitude, radio=is_radio)
    if station.troposphere:
        straight = elevation - by_air.get("elevation", 0.0)
        late = refraction.delay(straight, station.latitude, station.altitude)
        blind = rows[rows["range"].notna() & ~np.isfinite(late)]
        if not blind.empty:
            raise _wrong(blind, f"elevations with ranges, as {station.name} measures through air", "none")
        by_air["range"] = late
        by_air["range_rate"] = np.gradient(late, rows["t"].to_numpy()) if len(rows) > 1 else np.zeros(1)
    return by_air


def _keys(names: pd.Series) -> pd.Series:
    """Return names as a sheet may have them: DSS-14 is dss14 there."""
    return names.map(lambda name: re.sub(r"[^a-z0-9]", "", name.lower()))


def _check_once(table: pd.DataFrame) -> None:
    """Raise InputError where a station measured twice at a time, or the same twice."""
    again = table.duplicated(["station", "t"])
    if again.any():
        row = table[again].iloc[0]
        raise _wrong(table[again], f"one measurement by {row['station']} at a time", "a second one")
    for _, rows in table.groupby("station", sort=False):
        _check_other(rows)
        _check_apart(rows)


def _check_other(rows: pd.DataFrame) -> None:
    """Raise InputError where two segments hold the same values of one station, as a copy with other times."""
    again = rows.duplicated(OBSERVABLES) & ~rows.duplicated(["segment", *OBSERVABLES])
    if again.any():
        row = rows[again].iloc[0]
        duplicates = rows[OBSERVABLES].eq(row[OBSERVABLES]) | (
            rows[OBSERVABLES].isna() & row[OBSERVABLES].isna()
        )
        first = rows[duplicates.all(axis=1)].iloc[0]
        raise _wrong(rows[again], f"other values than those of {_place_of(first)}", "the same")


def _check_apart(rows: pd.DataFrame) -> None:
    """Raise InputError where segments of one station are within each other's steps, as a copy shifted."""
    ordered = rows.sort_values("t")
    gaps, step = ordered["t"].diff(), ordered.groupby("segment")["t"].diff().median()
    close = (gaps < _CLOSE * step) & (ordered["segment"] != ordered["segment"].shift())
    if close.any():
        at = int(close.to_numpy().argmax())
        before = ordered.iloc[at - 1]
        expected = f"no time so close to that of {_place_of(before)}, by the same station"
        got = f"one {gaps.iloc[at]:.3g} s later: is a file given twice?"
        raise _wrong(ordered.iloc[at:], expected, got)


def _place_of(row: pd.Series) -> str:
    return f"{row['path']}, line {row['line']}"


def _check_degrees(table: pd.DataFrame) -> None:
    """Raise InputError where all angles are as small as if they were in radians."""
    for names in (ANGLES[:2], ANGLES[2:]):
        degrees = np.degrees(table[names].dropna().to_numpy())
        if len(degrees) >= ENOUGH and np.all(np.abs(degrees) <= [2.0 * np.pi, 0.5 * np.pi]):
            expected = "angles in degrees"
            raise _wrong(table, expected, f"none beyond {degrees.max():.3g}, as if they were in radians")


def _check_limits(table: pd.DataFrame, stations: Mapping[str, Station]) -> None:
    """Raise InputError for elevations and ranges beyond what a station sees, by more than noise."""
    for name, rows in table.groupby("station", sort=False):
        station = stations[str(name)]
        for quantity, low, high, unit, scale in (
            ("elevation", station.min_elevation, station.max_elevation, "deg", np.degrees(1.0)),
            ("range", 0.0, station.max_range, "km", 1e-3),
        ):
            margin = BEYOND_LIMITS * station.row.get(f"sigma_{quantity}", 0.0)
            measured = rows[rows[quantity].notna()]
            beyond = measured[~measured[quantity].between(low - margin, high + margin)]
            if not beyond.empty:
                limits = f"{quantity} of {scale * low:g} to {scale * high:g} {unit}, as {name} sees"
                raise _wrong(beyond, limits, f"{scale * beyond[quantity].iloc[0]:.6g}")


def _check_orbit(table: pd.DataFrame, stations: Mapping[str, Station]) -> None:
    """Raise InputError where places are too low for an orbit, or the usual speed is not that of an orbit."""
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
    """Return places (n, 3) in ITRF [m] where radars measured the RSO, NaN of other measurements."""
    sites = {name: site(stations[name]) for name in table["station"].unique()}
    position, to_horizon = (np.array([sites[name][k] for name in table["station"]]) for k in (0, 1))
    return place(table[QUANTITIES].to_numpy(), position, to_horizon)


def _margins(table: pd.DataFrame, stations: Mapping[str, Station]) -> np.ndarray:
    """Return how far noise may take a place up or down (n,) [m]."""
    names = table["station"].unique()
    sigma = table["station"].map({name: stations[name].row.get("sigma_elevation", np.nan) for name in names})
    return np.asarray(BEYOND_LIMITS * sigma * table["range"])


def _speeds(table: pd.DataFrame, places: np.ndarray) -> list[float]:
    """Return the squared speed of each long track of one station, as a part of that of a circular orbit."""
    speeds = []
    for _, rows in table[np.isfinite(places[:, 0])].groupby(["station", _runs(table)]):
        rows = rows.sort_values("t")
        t = rows["t"].to_numpy()
        if len(t) >= 5 and t[-1] - t[0] >= _SHORTEST:
            t = t - t[0]
            times, three = smoothed(t, unturned(t, places[rows.index]))
            # By their times, as Gibbs's method would make an orbit of any three places.
            velocity = herrick_gibbs(three, times, EARTH_GM)
            speeds.append(float(velocity @ velocity * np.linalg.norm(three[1]) / EARTH_GM))
    return speeds


def _runs(table: pd.DataFrame) -> pd.Series:
    """Return the number of each row's run of one station's measurements without a long gap."""
    ordered = table.sort_values(["station", "t"])
    breaks = (ordered["t"].diff().abs() > LONGEST_GAP) | (ordered["station"] != ordered["station"].shift())
    return breaks.cumsum().reindex(table.index)


def _numbered(table: pd.DataFrame) -> np.ndarray:
    """Return the number (n,) of each row's track, of rows by time."""
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
    row = rows.iloc[0]
    return InputError(f"{row['path']}: line {row['line']}: expected {expected}, got {got}")
