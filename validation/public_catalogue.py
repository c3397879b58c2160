"""Holds predictions of many public objects against the orbits inside their later sets:

    python -m validation.public_catalogue ERRORS.csv [SETS WEATHER MODEL DATE...]

On each DATE (UTC text) objects of four bands of height are drawn from SETS, a file of element sets, and
predicted as `opml predict` does. WEATHER is a CSSI file, MODEL one of `opml train`, learned before the first
date from objects with even numbers. The later set nearest to date plus lead judges, at its epoch: by the
orbit inside it, or by itself where its object has none. Rows are appended to ERRORS.csv date by date; tables
tell what that file has.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.benchmark.scores import drawn_weights, weighted_median
from opml.element_sets import catalogue as catalogues
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside import inside_forces, inside_sizes, set_orbits
from opml.element_sets.inside.orbit_inside import LIGHT
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.element_sets.prediction import Prediction, PublicMorning
from opml.element_sets.set_errors import REACH
from opml.interop.element_sets import known_sets, mean_elements
from opml.interop.element_sets.element_set import ElementSet, changed, seconds_since
from opml.interop.predicted_orbit import LEADS
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import half_width
from opml.tables import STATE

HEIGHTS = 1e3 * np.array([180.0, 450.0, 600.0, 800.0, 2000.0])
"""Edges of the bands of mean height [m]."""

EACH = 15  # objects of a band and date
SEED = 42
_LEVEL = 0.9
_AXES = ("r", "s", "w")
_INTERVAL = (2.5, 97.5)


def drawn(catalogue: ElementCatalogue, date: str) -> np.ndarray:
    """Return the numbers of objects with a set known on a date, EACH of a band at most."""
    newest = catalogue.until(epochs.mjd(date)).newest().table
    fresh = newest[newest["t"] >= epochs.mjd(date) - 1.5]
    bands = fresh.groupby(np.searchsorted(HEIGHTS, fresh["height"]))["number"]
    orders = [derive(SEED, date).permutation(np.sort(numbers)) for _, numbers in bands]
    return np.concatenate([order[:EACH] for order in orders])


def errors(
    catalogue: ElementCatalogue,
    histories: dict[int, list[ElementSet]],
    morning: PublicMorning,
    numbers: np.ndarray,
) -> pd.DataFrame:
    """Return a row an object and lead: what is off in RSW [m], its sigmas, and who judged.

    catalogue: all sets; histories: those of each object; morning: what was public; numbers: (objects,)

    Raises InputError where no later set judges.
    """
    predictions, judges = {}, []
    now = epochs.mjd(morning.better.date)
    outcomes = morning.predict_side_by_side([histories[number] for number in numbers])
    for number, outcome in zip(numbers, outcomes, strict=True):
        if isinstance(outcome, InputError):
            print(f"{morning.better.date} {number}: {outcome}", file=sys.stderr)
            continue
        predictions[number] = outcome
        judges += [(number, lead, row) for lead, row in _judges(catalogue.table, int(number), now)]
    if not judges:
        expected = f"expected objects with sets of the week after {morning.better.date}"
        raise InputError(f"element sets: {expected}, got none")
    rows = np.array([row for *_, row in judges])
    sets = catalogue.take(rows)
    forces = inside_forces.read(morning.weather, first=sets.table["t"].min(), last=sets.table["t"].max())
    spans, reflection = _alike([predictions[number] for number, *_ in judges], sets)
    inside = set_orbits.states(sets, forces, np.full(len(rows), np.nan), spans, reflection)[
        [*STATE]
    ].to_numpy()
    return pd.DataFrame(
        [
            _row(predictions[number], sets.satellites[k], inside[k]) | {"number": number, "lead": lead}
            for k, (number, lead, _) in enumerate(judges)
        ]
    )


def _alike(predictions: Sequence[Prediction], judges: ElementCatalogue) -> tuple[np.ndarray, np.ndarray]:
    """Return spans and Cr A/m of sets that judge: those of the orbits that are predicted."""
    spans, reflection = set_orbits.usual_spans(judges), np.full(len(predictions), LIGHT)
    for row, one in enumerate(predictions):
        if isinstance(one.inside, OrbitInside):
            now = one.inside.now
            spans[row] = now.calibration.span.before, now.calibration.span.after
            reflection[row] = now.orbit.reflection(now.numbers)
    return spans, reflection


def _judges(table: pd.DataFrame, number: int, now: float) -> Iterator[tuple[int, int]]:
    """Yield leads and the rows of the sets that judge them: none from before the date, or after the last."""
    own = np.flatnonzero((table["number"] == number) & table["t"].between(now, now + LEADS[-1]))
    for lead in LEADS:
        away = np.abs(table["t"].to_numpy()[own] - now - lead)
        if len(own) and away.min() <= REACH:
            yield lead, int(own[away.argmin()])


def _row(prediction: Prediction, judge, inside: np.ndarray) -> dict[str, object]:
    """Return the errors at the epoch of a set, by the orbit inside it (6,) or by itself."""
    t = seconds_since(prediction.date, [judge])
    by_orbit = isinstance(prediction.inside, OrbitInside) and bool(np.isfinite(inside).all())
    by_set = mean_elements.states(judge, epoch=prediction.date, t=t)
    truth = inside[None] if by_orbit else by_set
    improved = changed(prediction.published, prediction.how["motion"], prediction.how["bstar"])
    flown = {
        "": prediction.states(t),
        "sgp4_": mean_elements.states(prediction.published, epoch=prediction.date, t=t),
        "improved_": mean_elements.states(improved, epoch=prediction.date, t=t),
        "later_": by_set,
    }
    values = {name: bent_rsw(states[:, :3], truth)[0] for name, states in flown.items()}
    values |= {"sigma_": prediction.sigmas(t)[0], "judge_sigma_": inside_sizes.at_epoch(judge)}
    return {
        "date": prediction.date,
        "height": prediction.how["height"],
        "days": t[0] / DAY,
        "why": "" if isinstance(prediction.inside, OrbitInside) else prediction.inside,
        "judge": "orbit" if by_orbit else "set",
        "span": prediction.inside.now.calibration.span.before if by_orbit else np.nan,
    } | {
        f"{name}{axis}": value for name, own in values.items() for axis, value in zip(_AXES, own, strict=True)
    }


def append(path: Path, sets: str, weather: str, model: str, dates: Sequence[str]) -> None:
    """Append the errors of dates to a table."""
    catalogue, histories = catalogues.read([sets]), known_sets.by_object([sets])
    for date in dates:
        morning = PublicMorning.read([sets], date=date, weather=weather, trained=model)
        rows = errors(catalogue, histories, morning, drawn(catalogue, date))
        rows.to_csv(path, mode="a", header=not path.exists(), index=False)


SHARES = {"radial": ("r", "sgp4_r"), "along-track": ("s", "sgp4_s"), "cross-track": ("w", "sgp4_w")}
"""Columns of the table: errors, and those in % of whose median theirs is."""

_IMPROVED = {"along-track, `improve`": ("improved_s", "sgp4_s")}


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return `medians` of orbits inside and improved sets, and errors inside intervals of nine in ten [%]."""
    inside = rows[(rows["why"] == "") & (rows["judge"] == "orbit")]
    inside = inside.assign(morning=[epochs.mjd(date) for date in inside["date"]])
    is_held = pd.DataFrame(
        {axis: inside[axis].abs() <= half_width(_LEVEL) * inside[f"sigma_{axis}"] for axis in _AXES}
    )
    held = 100.0 * is_held.groupby([_bands(inside), inside["lead"]]).mean()
    shares = (" / ".join(f"{share:.0f}" for share in row) for row in held.to_numpy())
    return medians(inside, SHARES | _IMPROVED).assign(**{"inside 90 % [%]": [*shares]})


def medians(rows: pd.DataFrame, shares: Mapping[str, tuple[str, str]]) -> pd.DataFrame:
    """Return median errors by band and lead in % of SGP4's, with intervals of 95 % over weeks and objects.

    rows: with number, morning, height, lead, and the columns of shares; shares: as SHARES
    """
    cells = []
    for (band, lead), part in rows.groupby([_bands(rows), "lead"]):
        rng = derive(SEED, band, str(lead))
        counts = {"days": lead, "n": len(part), "objects": part["number"].nunique()}
        sgp4 = " / ".join(f"{part[other].abs().median():.0f}" for _, other in SHARES.values())
        columns = {f"{name} [%]": _share(part, *pair, rng) for name, pair in shares.items()}
        cells.append({"height [km]": band, **counts, "SGP4 [m]": sgp4, **columns})
    return pd.DataFrame(cells)


def _bands(rows: pd.DataFrame) -> pd.Series:
    """Return the band of each row in words."""
    names = [f"{low:g}-{high:g}" for low, high in pairwise(HEIGHTS / 1e3)]
    return pd.cut(rows["height"], HEIGHTS, labels=names).astype(str)


def _share(part: pd.DataFrame, own: str, other: str, rng: np.random.Generator) -> str:
    """Return the median size of one column in % of that of another, with its interval."""
    sizes = [part[name].abs().to_numpy() for name in (own, other)]
    orders = [np.argsort(size, kind="stable") for size in sizes]
    draws = []
    for weights in drawn_weights(part, rng):
        drawn = [weighted_median(size[k], weights[k]) for size, k in zip(sizes, orders, strict=True)]
        draws.append(100.0 * drawn[0] / drawn[1])
    share, (low, high) = 100.0 * np.median(sizes[0]) / np.median(sizes[1]), np.percentile(draws, _INTERVAL)
    return f"{share:.0f} ({low:.0f}-{high:.0f})"


def verdicts(rows: pd.DataFrame) -> pd.DataFrame:
    """Return by band predictions and objects, and how many were told `as published`.

    Of those that were told an orbit inside, how many were worse than SGP4 in the median of their errors:
    radially, across, and in distance.
    """
    band = _bands(rows)
    is_inside = rows["why"] == ""
    counts = {
        "predictions": rows.drop_duplicates(["date", "number"]).groupby(band).size(),
        "as published": rows[~is_inside].drop_duplicates(["date", "number"]).groupby(band).size(),
        "objects inside": rows[is_inside].groupby(band)["number"].nunique(),
    }
    for name, axes in {"worse in R": "r", "worse in W": "w", "worse in distance": "rsw"}.items():
        sizes = [
            np.hypot.reduce(rows[[f"{way}{axis}" for axis in axes]].to_numpy(), axis=1)
            for way in ("", "sgp4_")
        ]
        ratio = pd.Series(sizes[0] / sizes[1], rows.index)[is_inside].groupby([band, rows["number"]]).median()
        counts[name] = (ratio > 1.0).groupby(level=0).sum()
    return pd.DataFrame(counts).fillna(0).astype(int).rename_axis("height [km]").reset_index()


def main(arguments: Sequence[str]) -> None:
    """Append errors, and print what the table has."""
    path = Path(arguments[0])
    if arguments[1:]:
        try:
            append(path, *arguments[1:4], arguments[4:])
        except InputError as reason:
            sys.exit(str(reason))
    rows = pd.read_csv(path, keep_default_na=False)
    for part in (table(rows), verdicts(rows)):
        part.to_csv(sys.stdout, sep="\t", index=False)


if __name__ == "__main__":
    main(sys.argv[1:])
