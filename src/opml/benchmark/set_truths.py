"""Truths of tasks of element sets: the orbit inside the later set that judges, or that set itself."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from opml.benchmark import tasks
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside import set_states
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch
from opml.orbits.elements import bent_rsw

Judge = Callable[[ElementCatalogue, str | Path], pd.DataFrame]
"""Returns the truth at the epochs of sets under a weather, columns of tasks.TRUE, NaN without one."""


def themselves(sets: ElementCatalogue, weather: str | Path) -> pd.DataFrame:
    """Return the states that SGP4 has of sets at their epochs."""
    states = [
        mean_elements.state(satellite, epoch=elements_epoch(satellite)) for satellite in sets.satellites
    ]
    return pd.DataFrame(states, columns=[*tasks.STATE])


def inside(sets: ElementCatalogue, weather: str | Path) -> pd.DataFrame:
    """Return the orbits inside sets at their epochs, and what the sets themselves are off them.

    weather: OBSERVED, the packaged weather, or a CSSI file; that after a set is as it was measured since

    Raises InputError where it does not reach.
    """
    since = ElementCatalogue(sets.table.assign(known=np.inf), sets.satellites)
    table = set_states.build(since, weather=weather)
    own = themselves(sets, weather).to_numpy()
    off = bent_rsw(own[:, :3], table[[*tasks.STATE]].to_numpy())
    return table[[*tasks.STATE, *tasks.SIGMAS]].assign(**dict(zip(tasks.OF_SET, off.T, strict=True)))
