"""A catalogue's improved sets in a few lines: counts, reasons, and the errors expected at each height."""

from itertools import pairwise

import numpy as np
import pandas as pd

from opml.base.progress import counted
from opml.element_sets.features import BANDS
from opml.element_sets.weighting import UNCHANGED

_LEADS = (1, 7)  # days
_SIGMAS = {"sgp4": "SGP4", "sigma": "improved"}  # columns, and their heads


def text(table: pd.DataFrame) -> str:
    """Return the table `improved_sets` as counts and medians of one sigma along the track by height [m]."""
    edges = 1e-3 * BANDS
    names = [f"{low:g}-{high:g}" for low, high in pairwise(edges)]
    bands = pd.cut(table["height"], BANDS, right=False, labels=names).rename("height [km]")
    columns = {f"{kind}_{lead}d": f"{name} {lead} d" for lead in _LEADS for kind, name in _SIGMAS.items()}
    known = table[np.isfinite(table["sigma_1d"])].rename(columns=columns).groupby(bands, observed=True)
    medians = known[[*columns.values()]].median()
    medians.insert(0, "objects", known.size())
    return "\n".join([_counts(table), *_lines(medians)])


def _counts(table: pd.DataFrame) -> str:
    """Return how many objects there are by what was applied, and why their sets are as published."""
    applied = [f"{count} {name}" for name, count in table["applied"].value_counts().items()]
    stays = table.loc[table["applied"] == UNCHANGED, "why"].replace("", "no gain on its last mornings")
    why = [f"{reason}: {count}" for reason, count in stays.value_counts().items()]
    reasons = f"; reasons: {', '.join(why)}" if why else ""
    return f"{counted(len(table), 'object')}, corrected along the track: {', '.join(applied)}{reasons}"


def _lines(medians: pd.DataFrame) -> list[str]:
    if medians.empty:
        return []
    shown = medians.reset_index().to_string(index=False, float_format="{:.0f}".format)
    return ["expected errors along the track, one sigma [m], medians over objects:", shown]
