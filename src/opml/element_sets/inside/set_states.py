"""A table of states of many objects: the orbit inside each of their public sets, at its epoch."""

import logging
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.files import FilePath
from opml.base.progress import Progress
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside import inside_forces, inside_now, inside_sizes, set_orbits
from opml.element_sets.inside.orbit_inside import usual_half_span
from opml.interop.element_sets.element_set import elements_epoch
from opml.tables import STATE, read_table

SCHEMA = "set_states"
NO_ORBIT = "no orbit under full forces fits"
OLD = f"published before {inside_now.MODERN}"

_MONTH = 30.0  # days of sets that share their forces
_NUMBERS = [*STATE, "ballistic"]

_log = logging.getLogger(__name__)


def build(
    catalogue: ElementCatalogue,
    *,
    weather: str | Path,
    before: pd.Series | None = None,
    progress: Progress = lambda line: None,
) -> pd.DataFrame:
    """Return the table `set_states` of the sets of a catalogue.

    before: Cd A/m by object as `read_before` has it; with it half of the work is done

    Reasons why sets are as published are counted in the log. Raises InputError where the weather does not
    reach.
    """
    satellites = catalogue.satellites
    epochs = [elements_epoch(one) for one in satellites]
    sigmas = np.array([inside_sizes.at_epoch(one) for one in satellites]).reshape(-1, 3)
    table = pd.DataFrame(
        {
            "number": catalogue.table["number"],
            "utc": epochs,
            **dict.fromkeys(_NUMBERS, np.nan),
            "half_span": [usual_half_span(one) / HOUR for one in satellites],
            **dict(zip(("sigma_r", "sigma_s", "sigma_w"), sigmas.T, strict=True)),
            "why": [
                inside_now.unsuited(one) or (OLD if epoch < inside_now.MODERN else "")
                for one, epoch in zip(satellites, epochs, strict=True)
            ],
        }
    )
    sought = np.flatnonzero(table["why"] == "")
    months = np.floor(catalogue.table["t"].to_numpy()[sought] / _MONTH)
    ballistic = table["number"].map(before if before is not None else {}).to_numpy(float)
    for month in np.unique(months):
        rows = sought[months == month]
        progress(f"the orbits inside {len(rows)} sets of 30 days from {table['utc'][rows].min()[:10]} on")
        part = catalogue.take(rows)
        forces = inside_forces.read(weather, first=part.table["t"].min(), last=part.table["t"].max())
        spans = set_orbits.usual_spans(part)
        table.loc[rows, _NUMBERS] = set_orbits.states(part, forces, ballistic[rows], spans)[
            _NUMBERS
        ].to_numpy()
    table.loc[(table["why"] == "") & table[_NUMBERS].isna().any(axis=1), "why"] = NO_ORBIT
    published = table["why"] != ""
    table.loc[published, [*_NUMBERS, "half_span", "sigma_r", "sigma_s", "sigma_w"]] = np.nan
    for reason, count in table.loc[published, "why"].value_counts().items():
        _log.warning("sets as published: %d: %s", count, reason)
    return table


def read_before(path: FilePath) -> pd.Series:
    """Return Cd A/m [m2/kg] by object of the last set in a table `set_states`; raises as `read_table`."""
    table = read_table(path, SCHEMA).dropna(subset="ballistic").sort_values("utc", kind="stable")
    return table.groupby("number")["ballistic"].last()
