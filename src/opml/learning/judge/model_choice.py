"""The choice of the model to use next, by replays that are over.

Among the models that learn nothing, the one that left the least is chosen. Newer errors weigh more, and those
of each day of duration have the same weight. A model that learned is selected only where the past shows with
confidence that it leaves less, in that measure and in metres. A bootstrap over blocks of the days on which
predictions ended gives the confidence.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.learning.data.splits import are_over
from opml.learning.judge.error_sizes import MEMORY_DAYS
from opml.tables import COMPONENTS, DOUBT

CONFIDENCE = 0.95
"""Confidence required that a model that learned leaves less than the best model that learned nothing."""

BLOCK_DAYS = 3.0
"""Predictions that ended within so many days are one piece of evidence, because they share their weather."""

LEAST_BLOCKS = 4  # least number of such pieces

_DRAWS = 1000
_COMPARED = ["i", "j", "t_j", "duration", "e_y"]  # columns of what is compared


@dataclass(frozen=True)
class Choice:
    """The model of a morning, and the comparison that it follows from."""

    chosen: str  # the model to use
    plain: str  # the best model that learned nothing
    law: str | None = None  # the best model that learned, None where none was replayed for long enough
    ratio: float = float("nan")  # error that the law left in the past, divided by that of the plain model
    high: float = float("nan")  # upper bound of the ratio, at CONFIDENCE


def choose(replays: Mapping[str, pd.DataFrame], laws: Sequence[str], *, now: float, seed: int) -> Choice:
    """Choose the model to use from `now` [s] on, by the rows of `replay` tables that are known by then.

    replays: by model
    laws: models that learned
    seed: of the bootstrap

    Raises InputError where nothing is known yet of the models that learned nothing.
    """
    plains = [name for name in replays if name not in laws]
    past = _Past.over_by(replays, plains, now) if plains else None
    plain = past.best(plains) if past else None
    if past is None or plain is None:
        raise InputError(f"choice: expected replays that were over by day {now / DAY:g}, got none")
    compared = {law: past.ratio(law, plain, seed) for law in laws if law in replays}
    ratios = {law: ratio for law, ratio in compared.items() if ratio is not None}
    if not ratios:
        return Choice(plain, plain)
    law = min(ratios, key=lambda name: ratios[name][1])
    ratio, high = ratios[law]
    return Choice(law if high < 1.0 else plain, plain, law, ratio, high)


@dataclass(frozen=True)
class _Past:
    """Sizes of e_y that models left, by pair (i, j)."""

    sizes: Mapping[str, np.ndarray]  # (pairs,) of each model [m], NaN where it has none
    typical: np.ndarray  # (pairs,) typical size of the pair's day of duration [m]
    weight: np.ndarray  # (pairs,)
    block: np.ndarray  # (pairs,) number of the block of days in which the prediction ended

    @classmethod
    def over_by(cls, replays: Mapping[str, pd.DataFrame], plains: Sequence[str], now: float) -> Self:
        """Return what `replay` tables by model showed by `now` [s]; plains: models that learned nothing."""
        over = {name: are_over(table, now) for name, table in replays.items()}
        known = {
            name: [table[column].to_numpy()[over[name]] for column in _COMPARED]
            for name, table in replays.items()
        }
        span = 1 + max(int(j.max(initial=0)) for _, j, *_ in known.values())
        pairs = np.unique(np.concatenate([span * i + j for i, j, *_ in known.values()]))
        ended, duration = np.empty((2, len(pairs)))
        sizes = {name: np.full(len(pairs), np.nan) for name in known}
        for name, (i, j, t_j, lasted, e_y) in known.items():
            place = np.searchsorted(pairs, span * i + j)
            ended[place], duration[place], sizes[name][place] = t_j, lasted, np.abs(e_y)
        usual = _medians(np.stack([sizes[name] for name in plains]))
        day, typical = np.ceil(duration / DAY), np.full(len(pairs), np.nan)
        for number in np.unique(day):
            typical[day == number] = _medians(usual[day == number, None])
        weight, block = np.exp((ended - now) / (MEMORY_DAYS * DAY)), np.floor(ended / (BLOCK_DAYS * DAY))
        return cls(sizes, np.maximum(typical, 1.0), weight, block)

    def best(self, plains: Sequence[str]) -> str | None:
        """Return the model that left the least, by day of duration; None without a pair of all."""
        shared = np.isfinite(np.stack([self.sizes[name] for name in plains])).all(axis=0)
        if not shared.any():
            return None
        weight = (self.weight / self.typical)[shared]
        return min(plains, key=lambda name: float(np.sum(self.sizes[name][shared] * weight)))

    def ratio(self, law: str, plain: str, seed: int) -> tuple[float, float] | None:
        """Return the error that a law left, divided by that of a plain model, and an upper bound of this.

        Of two measures, by day of duration and metre by metre, the one with the larger bound counts.
        Returns None for too few blocks.
        """
        rows = np.isfinite(self.sizes[law] + self.sizes[plain])
        _, place = np.unique(self.block[rows], return_inverse=True)
        count = place.max(initial=-1) + 1
        if count < LEAST_BLOCKS:
            return None
        ratios = []
        for unit in (self.typical[rows], 1.0):
            blocks = np.array(
                [
                    np.bincount(place, self.sizes[name][rows] / unit * self.weight[rows])
                    for name in (law, plain)
                ]
            )
            drawn = derive(seed, "choice", law).integers(count, size=(_DRAWS, count))
            laws, plains = blocks[:, drawn].sum(axis=2)
            high = float(np.quantile(laws / plains, CONFIDENCE))
            ratios.append((float(blocks[0].sum() / blocks[1].sum()), high))
        return max(ratios, key=lambda ratio: ratio[1])


def _medians(values: np.ndarray) -> np.ndarray:
    """Return the medians (n,) of the numbers among values (k, n), NaN where all are NaN."""
    ordered, count = np.sort(values, axis=0), np.isfinite(values).sum(axis=0)
    middle = np.stack([(count - 1) // 2, count // 2])
    medians: np.ndarray = np.take_along_axis(ordered, np.minimum(middle, len(values) - 1), axis=0).mean(
        axis=0
    )
    return medians


CHOSEN = "selected each day"  # what the models that were selected are called among the others


@dataclass(frozen=True)
class Mornings:
    """Replays of several models on the same predictions, and of those that the past would have chosen."""

    tables: Mapping[str, pd.DataFrame]  # `replay` rows of each model, of the same pairs in the same order
    selected: pd.DataFrame  # rows of the models that were chosen
    choices: Mapping[float, Choice]  # by morning [s]
    earlier: int  # predictions from before all models could be selected, which count nowhere

    @property
    def last_choice(self) -> str:
        """The model that the past chose on the last morning."""
        return self.choices[max(self.choices)].chosen

    def best(self, names: Iterable[str]) -> str:
        """Return which of these models left least in all, as is known in hindsight only."""
        return min(names, key=lambda name: summed(self.tables[name]))

    @classmethod
    def from_replays(cls, replays: Mapping[str, pd.DataFrame], laws: Sequence[str], *, seed: int) -> Self:
        """Choose on every morning from `replay` tables by model.

        laws: models that learned

        Raises InputError where no morning has all models and a choice.
        """
        first = max(float(table["morning"].min()) for table in replays.values())
        mornings = np.unique(np.concatenate([table["morning"].unique() for table in replays.values()]))
        choices: dict[float, Choice] = {}
        for now in mornings[mornings >= first]:
            try:
                choices[float(now)] = choose(replays, laws, now=float(now), seed=seed)
            except InputError:
                continue
        pairs = _shared_pairs(replays, list(choices))
        if not choices or pairs.empty:
            raise InputError("replays: expected a morning with a past and all models, got none")
        tables = {
            name: table.set_index(["i", "j"]).loc[pairs].reset_index() for name, table in replays.items()
        }
        longest = max(replays.values(), key=len)
        chosen = ((now, tables[choice.chosen]) for now, choice in choices.items())
        selected = pd.concat([table[table["morning"] == now] for now, table in chosen], ignore_index=True)
        return cls(tables, selected, choices, int((longest["morning"] < min(choices)).sum()))

    def against_truth(self, truth: pd.DataFrame, labelled: pd.DataFrame) -> Self:
        """Return the same mornings, and choices, with errors against the truth in the place of labels.

        truth: table `dataset`, with true errors
        labelled: the table `labelled` of the same pairs, which replays were compared with

        Pairs without a true state are left out. RSW of the true state and of a label differ by less than
        counts.
        """
        errors = [table.set_index(["i", "j"])[list(COMPONENTS)] for table in (truth, labelled)]
        shifts = (errors[0] - errors[1]).dropna()
        tables = {name: _moved(table, shifts) for name, table in self.tables.items()}
        return replace(self, tables=tables, selected=_moved(self.selected, shifts))


def _moved(replay: pd.DataFrame, shifts: pd.DataFrame) -> pd.DataFrame:
    """Return rows of a `replay` table with moved errors, by pair, against an exact reference."""
    pairs = pd.MultiIndex.from_frame(replay[["i", "j"]])
    rows, by = replay[pairs.isin(shifts.index)], shifts.reindex(pairs[pairs.isin(shifts.index)])
    errors = {name: rows[name] + by[name].to_numpy() for name in COMPONENTS}
    before = rows["before"] + by["e_y"].to_numpy()
    without = dict.fromkeys(DOUBT, 0.0)
    return rows.assign(**errors, before=before, **without).reset_index(drop=True)


def summed(replay: pd.DataFrame) -> float:
    """Return |e_y| summed over the rows of a `replay` table [m]."""
    return float(replay["e_y"].abs().sum())


def _shared_pairs(replays: Mapping[str, pd.DataFrame], mornings: Sequence[float]) -> pd.MultiIndex:
    of_model = [
        pd.MultiIndex.from_frame(table.loc[table["morning"].isin(mornings), ["i", "j"]])
        for table in replays.values()
    ]
    shared = of_model[0]
    for pairs in of_model[1:]:
        shared = shared[shared.isin(pairs)]
    return shared
