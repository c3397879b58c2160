"""Features of the corrector: drag, density and the object's past errors.

Notation, of the newest set: epoch T, b its B*, tau the time from T to what is predicted, kappa = 2 g / tau^2
with g the response of the along-track position to B*, y(tau) the density integrated twice from T on. A fit
c0 + c1 s + c2 s^2 / 2 to y over a window is what an orbit determination with constant drag makes of a density
that varies. The level of drag from N sets is the median of b / c2 over the last N, each in a window about its
own epoch. The density-scaled prediction takes Q = kappa (b tau^2 / 2 - level y) off SGP4's. Distances are in
units of a scale: the drag's own displacement and 30 m a day.
"""

import warnings
from collections.abc import Mapping

import numpy as np
import pandas as pd

from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.density import Air, MorningDensity
from opml.element_sets.set_errors import BACK, LEADS

BANDS = 1e3 * np.array([300.0, 400.0, 450.0, 500.0, 550.0, 600.0, 700.0, 1000.0])
"""Edges of the bands of height [m]; what lies outside is not corrected."""

MOST_ECCENTRICITY = 0.02
"""Largest eccentricity of an orbit that is corrected: its drag is that of its mean height."""

FLOOR = 30.0  # what a prediction is off by without any drag [m/d]
OWN = (3, 12)  # numbers of the object's own mornings whose errors count
_RECENT = (1, 2, 3)  # days since the mornings whose common miss a day ahead still counts

LASTING = dict(zip(LEADS, (0.3, 0.25, 0.2, 0.15), strict=True))
"""Part of a common miss that is there again, by lead [d]."""

_FEWEST_OF_BAND = 5  # objects below which a band has no common miss

_DAY_BEFORE = (-1.0, 0.0)
_WINDOWS = ((-2.0, 0.0), (-1.0, 1.0), (-2.0, 1.0), (-3.0, 1.5), (0.0, 1.0))
_LEVELS = (
    (_DAY_BEFORE, 1),
    (_DAY_BEFORE, 3),
    (_DAY_BEFORE, 5),
    (_DAY_BEFORE, 8),
    ((-1.0, 1.0), 2),
    ((-2.0, 1.0), 2),
)
_SETS = 8  # sets of an object that its levels look at

_NODES = 9
_OLD = 20.0  # age [d] against the newest set beyond which a set says nothing about the level

_CLIP = 50.0


def _name(window: tuple[float, float]) -> str:
    return "_".join(f"{edge:+g}" for edge in window)


DISTANCES = (
    *(f"level_{_name(window)}_{count}" for window, count in _LEVELS),
    *(f"window_{_name(window)}" for window in _WINDOWS),
    *(f"miss_{k + 1}_{power}" for k in range(BACK) for power in (1, 2)),
)
"""Differences between estimates of the drag, in scales.

As features they are less their medians of the band, lead and morning, as the target is.
"""

APART = tuple(f"{name}_apart" for name in DISTANCES)  # the features that these are

OWN_FEATURES = tuple(f"own_{count}_{what}" for count in OWN for what in ("mean", "size"))

FEATURES = (*APART, *("height", "inclination", "age", "drag", "lead", "tau"), *OWN_FEATURES)
"""All features, in the order of the model's columns."""

_MISSES = tuple(f"miss_{k + 1}_1" for k in range(BACK))

COLUMNS = ("band", "scale", "density", "target", "is_fit", "missed", *FEATURES)
"""Columns that `build` adds: band, scale [m], Q [m], what is to be learned, whether it can be corrected."""


def build(catalogue: ElementCatalogue, errors: tuple[pd.DataFrame, np.ndarray], air: Air) -> pd.DataFrame:
    """Return the rows of errors, of `set_errors.build`, with COLUMNS.

    air: gives the density about a morning, as it was known then

    The target is what the density-scaled prediction leaves, in scales, less its median over the band that
    morning: what all objects of a band share is the weather of the days ahead, and learning it would be
    learning the days. Own errors are those whose judge was known on the morning.
    """
    rows, past = errors
    table = np.full((len(rows), 2 + len(DISTANCES)), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):  # of sets without drag, and decayed ones
        for morning, members in rows.groupby("morning", sort=True).indices.items():
            table[members] = _of_morning(catalogue, rows.iloc[members], past, air(float(morning)))
        scale = table[:, 0]
        distances = np.divide(table[:, 2:], scale[:, None], out=table[:, 2:])
    np.clip(distances, -_CLIP, _CLIP, out=distances)
    differences = pd.DataFrame(distances, columns=list(DISTANCES), copy=False)
    sets = catalogue.table.iloc[rows["newest"]]
    height = sets["height"].to_numpy()
    whole = rows.reset_index(drop=True).assign(
        band=np.searchsorted(BANDS, height, side="right") - 1,
        scale=scale,
        density=table[:, 1],
        is_fit=_is_fit(sets, scale),
        height=height,
        inclination=sets["inclination"].to_numpy(),
        age=rows["morning"].to_numpy() - sets["t"].to_numpy(),
        drag=np.log(np.maximum(scale - FLOOR * rows["tau"].to_numpy(), 1e-3)),
    )
    groups = whole.groupby(["is_fit", "morning", "band", "lead"]).ngroup()
    whole["missed"] = differences[list(_MISSES)].abs().max(axis=1)
    for k, name in enumerate(DISTANCES):  # one by one: all at once would take a quarter more memory
        distances[:, k] -= differences[name].groupby(groups).transform("median").to_numpy()
    # A set that is not there says nothing: as if it agreed with the others.
    apart = pd.DataFrame(np.nan_to_num(distances, copy=False), columns=list(APART), copy=False)
    miss = ((whole["error"] - whole["density"]) / whole["scale"]).where(whole["is_fit"])
    whole["target"] = miss - miss.groupby(groups).transform("median")
    judged = whole[["morning", "lead", "band", "judged"]].assign(miss=miss)
    lasting = whole["lead"].map(LASTING) * common_misses(judged)
    whole["density"] += lasting * whole["scale"]
    return pd.concat([whole, apart, own_misses(whole).fillna(0.0)], axis=1)


def _is_fit(sets: pd.DataFrame, scale: np.ndarray) -> np.ndarray:
    """Return which rows can be corrected: nearly round, at a height with a band, with B* above 0."""
    height = sets["height"].to_numpy()
    return np.asarray(
        (sets["bstar"].to_numpy() > 0.0)
        & (sets["eccentricity"].to_numpy() < MOST_ECCENTRICITY)
        & (height >= BANDS[0])
        & (height < BANDS[-1])
        & np.isfinite(scale)
    )


def _of_morning(
    catalogue: ElementCatalogue, rows: pd.DataFrame, past: np.ndarray, air: MorningDensity
) -> np.ndarray:
    """Return scale, Q and DISTANCES of the rows of one morning, all in metres; past: distances of sets."""
    newest, row_of = np.unique(rows["newest"].to_numpy(), return_inverse=True)
    tau = rows["tau"].to_numpy()
    t, bstar, height = (catalogue.table[name].to_numpy() for name in ("t", "bstar", "height"))
    kappa = 2.0 * rows["response"].to_numpy() / tau**2
    before = _sets_before(catalogue, newest)
    levels = _levels(catalogue, before, air)
    level = levels[_DAY_BEFORE, 2][row_of]
    own, epochs = height[newest], t[newest]
    integral = air.displacement(own[row_of], epochs[row_of], tau[:, None])[:, 0]

    def taken_off(level: np.ndarray) -> np.ndarray:
        return np.asarray(kappa * (0.5 * bstar[newest][row_of] * tau**2 - level * integral))

    density = taken_off(level)
    columns = [np.abs(kappa * level * integral) + FLOOR * tau, density]
    columns += [taken_off(levels[key][row_of]) - density for key in _LEVELS]
    for window in _WINDOWS:
        fitted = _fitted(air, own, epochs, window)[row_of]
        columns.append(kappa * level * (fitted[:, 0] + fitted[:, 1] * tau))
    gaps = np.where(before[:, 1 : BACK + 1] >= 0, epochs[:, None] - t[before[:, 1 : BACK + 1]], np.nan)
    for k in range(BACK):
        reach = tau / gaps[row_of, k]
        miss = past[newest, k][row_of]
        columns += [miss * reach, miss * reach**2]
    return np.column_stack(columns)


def _sets_before(catalogue: ElementCatalogue, newest: np.ndarray) -> np.ndarray:
    """Return the sets (n, _SETS) of an object, the newest first; -1 where there is none."""
    number, t = catalogue.table["number"].to_numpy(), catalogue.table["t"].to_numpy()
    before = newest[:, None] - np.arange(_SETS)
    row = np.maximum(before, 0)
    is_own = (before >= 0) & (number[row] == number[newest][:, None])
    return np.where(is_own & (t[newest][:, None] - t[row] <= _OLD), before, -1)


def _levels(
    catalogue: ElementCatalogue, before: np.ndarray, air: MorningDensity
) -> Mapping[tuple[tuple[float, float], int], np.ndarray]:
    """Return the levels of drag (n,) by window and number of sets."""
    sets, place = np.unique(before, return_inverse=True)
    place = place.reshape(before.shape)
    t, bstar, height = (catalogue.table[name].to_numpy()[sets] for name in ("t", "bstar", "height"))
    levels: dict[tuple[tuple[float, float], int], np.ndarray] = {}
    for window in dict.fromkeys(window for window, _ in _LEVELS):
        each = np.where(before >= 0, (bstar / _fitted(air, height, t, window)[:, 2])[place], np.nan)
        counts = {2, *(count for other, count in _LEVELS if other == window)}
        levels |= {(window, count): _medians(each[:, :count]) for count in counts}
    return levels


def _fitted(
    air: MorningDensity, height: np.ndarray, t: np.ndarray, window: tuple[float, float]
) -> np.ndarray:
    """Return the coefficients (n, 3) of c0 + c1 s + c2 s^2 / 2 fitted to y(s) over a window about `t`."""
    after = np.linspace(*window, _NODES)
    design = np.linalg.pinv(np.column_stack([np.ones(_NODES), after, 0.5 * after**2]))
    return np.asarray(air.displacement(height, t, np.broadcast_to(after, (len(t), _NODES))) @ design.T)


def _medians(values: np.ndarray) -> np.ndarray:
    """Return medians (n,) of rows (n, m), NaN passed over."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of rows without any
        return np.asarray(np.nanmedian(values, axis=1))


def common_misses(rows: pd.DataFrame) -> np.ndarray:
    """Return the mean (n,) of the median errors of a band a day ahead on the last mornings, in scales.

    rows: with `miss` of the prediction with Q alone

    A miss counts if its judge is known on the row's morning; 0 where there are too few.
    """
    day = _days(rows)
    ahead = rows.assign(day=day)[(rows["lead"] == LEADS[0]) & np.isfinite(rows["miss"])]
    medians = []
    for lag in _RECENT:
        known = ahead[ahead["judged"] <= ahead["morning"] + lag]
        grouped = known.groupby([known["day"] + lag, "band"])["miss"].agg(["median", "size"])
        medians.append(grouped["median"].where(grouped["size"] >= _FEWEST_OF_BAND))
    means = pd.concat(medians, axis=1).mean(axis=1)
    of_row = means.reindex(pd.MultiIndex.from_arrays([day, rows["band"]]))
    return np.asarray(of_row.fillna(0.0), dtype=float)


def _days(rows: pd.DataFrame) -> np.ndarray:
    """Return the whole days (n,) of mornings since the first one."""
    return np.asarray(np.round(rows["morning"] - rows["morning"].min()).astype(int))


def own_misses(rows: pd.DataFrame) -> pd.DataFrame:
    """Return OWN_FEATURES: mean and mean size of an object's targets of the last mornings that are judged.

    Mornings are daily. A target counts a day after what was predicted, if its judge was known by then.
    """
    misses = np.full((len(rows), len(OWN_FEATURES)), np.nan)
    day = _days(rows)
    object_, numbers = pd.factorize(rows["number"])
    in_time = rows["judged"] <= rows["morning"] + rows["lead"] + 1.0
    target = rows["target"].where(in_time).to_numpy()
    for lead in LEADS:
        part = np.flatnonzero(rows["lead"] == lead)
        table = np.full((len(numbers), day.max(initial=0) + 1), np.nan)
        table[object_[part], day[part]] = target[part]
        for k, count in enumerate(OWN):
            for n, values in enumerate((table, np.abs(table))):
                means = _trailing_means(values, lead + 1, count)
                misses[part, 2 * k + n] = means[object_[part], day[part]]
    return pd.DataFrame(misses, columns=list(OWN_FEATURES), index=rows.index)


def _trailing_means(values: np.ndarray, lag: int, count: int) -> np.ndarray:
    """Return the means (n, m) over `count` columns up to the one `lag` before, NaN passed over."""
    known = np.isfinite(values)
    sums = [
        np.cumsum(np.pad(part, ((0, 0), (lag + count, 0))), axis=1)[:, : values.shape[1] + count]
        for part in (np.where(known, values, 0.0), known.astype(float))
    ]
    totals, counts = (part[:, count:] - part[:, :-count] for part in sums)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(counts > 0.5, totals / counts, np.nan))
