"""Which model to fly next, by what replays that are over have shown.

Among the models that learn nothing it is the one that left least, the newer errors weighing more and those of
each day of duration alike. One that learned is flown only where the past shows with confidence that it leaves
less, in that measure and in metres: by a bootstrap over blocks of the days that predictions ended on.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.learning.judge.error_sizes import MEMORY_DAYS

CONFIDENCE = 0.95
"""How sure the past has to be that a model that learned leaves less than the best one that did not."""

BLOCK_DAYS = 3.0
"""Predictions that ended within so many days are one piece of evidence, as they share their weather."""

LEAST_BLOCKS = 4
"""Pieces of evidence that this takes."""

_DRAWS = 1000


@dataclass(frozen=True)
class Choice:
    """The model of a morning: its name, the best that learned nothing, and how the best law compares to it.

    law: None where none was replayed for long enough; ratio: of what it left in the past by what the best
    plain one did; high: the ratio that CONFIDENCE of the resampled days stay below.
    """

    chosen: str
    plain: str
    law: str | None = None
    ratio: float = float("nan")
    high: float = float("nan")


def choose(replays: Mapping[str, pd.DataFrame], laws: Sequence[str], *, now: float, seed: int) -> Choice:
    """The model to fly from `now` [s] on, by the rows of `replay` tables that were known by then.

    replays: by model; laws: those that learned. Raises InputError where nothing is known yet of those that
    did not.
    """
    plains = [name for name in replays if name not in laws]
    past = _Past.known(replays, plains, now)
    plain = past.best(plains)
    if plain is None:
        raise InputError(f"choice: expected replays that were over by day {now / DAY:g}, got none")
    compared = {law: past.ratio(law, plain, seed) for law in laws if law in replays}
    tried = {law: found for law, found in compared.items() if found is not None}
    if not tried:
        return Choice(plain, plain)
    law = min(tried, key=lambda name: tried[name][1])
    ratio, high = tried[law]
    return Choice(law if high < 1.0 else plain, plain, law, ratio, high)


@dataclass(frozen=True)
class _Past:
    """Sizes of e_y of pairs (i, j) by model [m], in units of their day of duration, and what they weigh."""

    sizes: pd.DataFrame
    typical: pd.Series
    weight: pd.Series
    block: pd.Series

    @classmethod
    def known(cls, replays: Mapping[str, pd.DataFrame], plains: Sequence[str], now: float) -> Self:
        """What `replay` tables by model showed by `now` [s]."""
        known = {
            name: table[table["t_known"] <= now].set_index(["i", "j"]) for name, table in replays.items()
        }
        sizes = pd.DataFrame({name: table["e_y"].abs() for name, table in known.items()})
        pairs = pd.concat([table[["t_j", "duration"]] for table in known.values()])
        pairs = pairs[~pairs.index.duplicated()].reindex(sizes.index)
        day = np.ceil(pairs["duration"] / DAY)
        typical = sizes[list(plains)].median(axis=1).groupby(day).transform("median").clip(lower=1.0)
        weight = np.exp((pairs["t_j"] - now) / (MEMORY_DAYS * DAY))
        return cls(sizes, typical, weight, np.floor(pairs["t_j"] / (BLOCK_DAYS * DAY)))

    def best(self, plains: Sequence[str]) -> str | None:
        """The model that left least, each day of duration alike; None where nothing is known of all."""
        shared = self.sizes[list(plains)].dropna()
        if shared.empty:
            return None
        relative = shared.div(self.typical[shared.index], axis=0)
        return str(relative.mul(self.weight[shared.index], axis=0).sum().idxmin())

    def ratio(self, law: str, plain: str, seed: int) -> tuple[float, float] | None:
        """What a law left by what the plain model did, and its upper bound; None of too few blocks.

        The larger of both of two measures: each day of duration alike, and metre by metre.
        """
        rows = self.sizes[[law, plain]].dropna()
        measures = (rows.div(self.typical[rows.index], axis=0), rows)
        found = []
        for both in measures:
            blocks = (
                both.mul(self.weight[rows.index], axis=0).groupby(self.block[rows.index]).sum().to_numpy()
            )
            if len(blocks) < LEAST_BLOCKS:
                return None
            drawn = derive(seed, "choice", law).integers(len(blocks), size=(_DRAWS, len(blocks)))
            sums = blocks[drawn].sum(axis=1)
            high = float(np.quantile(sums[:, 0] / sums[:, 1], CONFIDENCE))
            found.append((float(blocks[:, 0].sum() / blocks[:, 1].sum()), high))
        return max(found, key=lambda one: one[1])


@dataclass(frozen=True)
class Mornings:
    """Replays of several models on the same predictions, and of what the past would have chosen.

    tables: rows of each model's `replay` table, of the same pairs in the same order; flown: those of the
    models that were chosen; choices: by the morning [s]; earlier: predictions that began before all models
    could be flown, which count nowhere.
    """

    tables: Mapping[str, pd.DataFrame]
    flown: pd.DataFrame
    choices: Mapping[float, Choice]
    earlier: int

    @classmethod
    def of(cls, replays: Mapping[str, pd.DataFrame], laws: Sequence[str], *, seed: int) -> Self:
        """What `replay` tables by model show; laws: those that learned.

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
        return cls(tables, _flown(tables, choices), choices, int((longest["morning"] < min(choices)).sum()))


def _shared_pairs(replays: Mapping[str, pd.DataFrame], mornings: Sequence[float]) -> pd.MultiIndex:
    """Pairs (i, j) of these mornings that every model has."""
    of_model = [
        pd.MultiIndex.from_frame(table.loc[table["morning"].isin(mornings), ["i", "j"]])
        for table in replays.values()
    ]
    shared = of_model[0]
    for pairs in of_model[1:]:
        shared = shared[shared.isin(pairs)]
    return shared


def _flown(tables: Mapping[str, pd.DataFrame], choices: Mapping[float, Choice]) -> pd.DataFrame:
    """Each morning's rows of the model that it chose."""
    parts = [tables[one.chosen][tables[one.chosen]["morning"] == now] for now, one in choices.items()]
    return pd.concat(parts, ignore_index=True)
