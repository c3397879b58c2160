"""SGP4 from the newest set, published or improved: models of the menu, and what a good ephemeris beats."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.element_sets.catalogue import modified_julian_day
from opml.element_sets.on_mornings import ImprovedHistory
from opml.element_sets.ways import DENSITY, LEARNED
from opml.interop.element_sets import histories, mean_elements
from opml.interop.element_sets.element_set import mean_height
from opml.mornings.candidates import Expected
from opml.mornings.judged import PAST, Verdict
from opml.mornings.outcomes import GOOD, WIDE
from opml.orbits.elements import in_rsw
from opml.tables import STATE

NAME = "sgp4"  # name of the model that is flown along the track where SGP4 is

_MINUTE = 60.0


@dataclass(frozen=True, eq=False)
class Sgp4:
    """What anybody would have flown of an object, and with the same sets improved.

    improved: the sets of all objects that are watched; None where nothing improves them
    """

    sets: pd.DataFrame  # table `element_sets` of the object
    epoch: str  # UTC text from which its times count
    improved: ImprovedHistory | None = None

    def is_above(self, least: float, *, now: float) -> bool:
        """Return whether the mean height of the newest set that is known [m] is not below the least.

        now: by when sets are known [s]
        """
        newest = histories.newest_before(self.sets, now)
        return newest is None or bool(mean_height(_MINUTE * self.sets["mean_motion"].iloc[newest]) >= least)

    def menu(self, now: float) -> dict[str, Expected]:
        """Return by model how far a path would be off along the track, were the object where SGP4 has it.

        now: by when sets are known [s]

        NaN where no set was known, and where SGP4 fails.
        """
        models = {NAME: partial(histories.predict, self.sets, epoch=self.epoch, known=now)}
        if self.improved is not None:
            number, morning = int(self.sets["number"].iloc[0]), modified_julian_day(self.epoch) + now / DAY
            for name in (DENSITY, LEARNED):
                flown = self.improved.newest(name, number, morning)
                if flown is not None:
                    models[name] = partial(mean_elements.states, flown, epoch=self.epoch)
        return {name: partial(_expected, states) for name, states in models.items()}


def beside(judgement: Verdict, judged: pd.DataFrame, *, now: float) -> Verdict:
    """Return a verdict, which is not good where SGP4 was nearer in the median of the last two weeks.

    judged: rows of that table of all mornings
    """
    both = _both(judged[judged["t_known"] > now - PAST])
    if judgement.word != GOOD or both.empty:
        return judgement
    ours, theirs = (float(both[name].abs().median()) for name in ("e_y", "sgp4"))
    if ours <= theirs:
        return judgement
    return Verdict(WIDE, f"SGP4 from the newest set was {theirs:.0f} m off where this was {ours:.0f}")


def medians(judged: pd.DataFrame) -> list[dict[str, Any]]:
    """Return by day ahead how far what was flown, and SGP4 at the same epochs, were off in the median [m].

    With the number of mornings that it was judged on.

    judged: rows of that table
    """
    both = _both(judged)
    by_day = both.groupby(np.ceil(both["duration"] / DAY).astype(int).rename("day"))
    sizes = by_day[["e_y", "sgp4"]].agg(lambda errors: errors.abs().median()).round(1)
    sizes = sizes.rename(columns={"e_y": "flown_m", "sgp4": "sgp4_m"})
    return sizes.assign(mornings=by_day["morning"].nunique()).reset_index().to_dict("records")


def _both(judged: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of what was flown where SGP4 was judged, too, with its error `sgp4` [m]."""
    keys = ["morning", "j"]
    sgp4 = judged[judged["model"] == NAME].set_index(keys)["e_y"].rename("sgp4")
    return judged[np.isfinite(judged["sigma_y"])].join(sgp4, on=keys, how="inner")


def _expected(states: Callable[..., np.ndarray], path: pd.DataFrame) -> np.ndarray:
    """Return how far a path is off along the track (n,) [m] of what gives states at times `t`."""
    predicted = np.ascontiguousarray(path[STATE])
    return in_rsw(predicted - states(t=path["t_j"].to_numpy()), predicted)[:, 1]
