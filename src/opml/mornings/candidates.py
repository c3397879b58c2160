"""The ephemerides of all models from the newest estimate of a morning: the table `paths`."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.ephemerides.along_track_shift import LEAST_EPOCHS
from opml.ephemerides.corrected import Spreads, expected, interpolate_spread
from opml.ephemerides.part import Part
from opml.learning.data.components import CORRECTED
from opml.learning.models import learners
from opml.learning.models.contract import Model, ResolvedSettings
from opml.tables import SPREAD, STATE

STEP = 300.0  # time between the epochs of these ephemerides [s]: decimetres from those of a minute
EVERY = 2  # so many epochs are to one that arcs fly to for the spread


def model(settings: ResolvedSettings, columns: pd.DataFrame) -> Model:
    """Return the model of a learner that learns nothing; columns: of its variables."""
    row = columns.head(1).assign(**{CORRECTED: 0.0})
    return learners.train(row, component=CORRECTED, settings=settings, seed=0)


Expected = Callable[[pd.DataFrame], np.ndarray]
"""How far a path is off along the track (n,) [m], by what another orbit says."""


def paths(
    part: Part,
    models: Mapping[str, ResolvedSettings],
    spreads: Spreads,
    *,
    now: float,
    others: Mapping[str, Expected],
) -> pd.DataFrame:
    """Return the ephemerides of models from the one start of a part, as far as all of them reach.

    models: resolved settings of learners that learn nothing, by name
    now: when they are made [s]
    others: orbits of other makers that may be flown along the track, by name
    """
    part.fly_together(learners.arc_windows(models.values()), _held_arcs(models.values()))
    table = part.pairs().assign(morning=now)
    for name, settings in models.items():
        table[f"e_y_{name}"] = _along(part, settings)
    for name, expected_by in others.items():
        table[f"e_y_{name}"] = expected_by(table)
    asked = [*STATE, *(f"e_y_{name}" for name in (*models, *others))]
    lost = ~np.isfinite(table[asked].to_numpy()).all(axis=1)
    reached = table[np.cumsum(lost) == 0]
    if len(reached) < LEAST_EPOCHS:
        raise InputError(f"ephemeris: expected at least {LEAST_EPOCHS} epochs ahead, got {len(reached)}")
    sparse = reached.iloc[::EVERY]
    causes = sparse[["t_j"]].join(spreads(sparse)[SPREAD].set_axis(sparse.index))
    return interpolate_spread(reached, causes).drop(columns=["j", "reason"])


def _held_arcs(settings: Iterable[ResolvedSettings]) -> list[tuple[float, float]]:
    """Return window [h] and memory [days] of the arcs with Cd held that models ask for, each once."""
    asking = (one for one in settings if "held" in learners.tables_asked(one.variables))
    return list(dict.fromkeys(arc for arc in map(learners.arc_of, asking) if arc))


def _along(part: Part, settings: ResolvedSettings) -> np.ndarray:
    """Return the e_y (n,) [m] that a model expects along a part's ephemeris, NaN where none reaches."""
    columns = part.columns(settings.variables, arc=learners.arc_of(settings))
    along = np.full(len(columns), np.nan)
    finite = np.isfinite(columns[[*STATE, *settings.variables]].to_numpy()).all(axis=1)
    if finite.any():
        along[finite] = expected(columns[finite], model(settings, columns[finite]))
    return along
