"""Conjunctions as text: one line each, for people, and for spreadsheets."""

from collections.abc import Iterable

import numpy as np
import pandas as pd

from opml.conjunctions.conjunction import Conjunction
from opml.interop import ccsds

_COLUMNS = [
    *("tca", "first", "second", "miss_m", "r_m", "s_m", "w_m"),
    *("speed_mps", "radius_m", "probability", "stated", "correlated", "method", "largest", "remark"),
]
NONE = "no approach within the distance of --within (5 km by default)"
_MORE = 1.5  # times the probability of an encounter that its revolution has to hold to be shown


def table(conjunctions: Iterable[Conjunction], *, epoch: str) -> pd.DataFrame:
    """Return a row per conjunction, the largest probability first, those without one last.

    Columns: tca, UTC text; first, second: names; miss_m; r_m, s_m, w_m of the second in RSW of the first;
    speed_mps; radius_m: sum of both radii; probability of a collision, stated: that of the message that was
    read, correlated: the same with the error of density that both share, the method that suffices for it, and
    the largest under any multiple of the covariance, NaN where unknown and, the largest, for a long
    encounter; remark
    """
    rows = []
    for one in conjunctions:
        relative, chance = one.relative, one.chance
        together = one.correlated.chance if one.correlated else None
        rows.append(
            {
                "tca": one.t,
                "first": str(one.first.identity),
                "second": str(one.second.identity),
                "miss_m": float(np.linalg.norm(relative[:3])),
                **dict(zip(("r_m", "s_m", "w_m"), relative[:3].tolist(), strict=True)),
                "speed_mps": float(np.linalg.norm(relative[3:])),
                "radius_m": one.radius,
                "probability": chance.probability if chance else np.nan,
                "stated": np.nan if one.stated is None else one.stated,
                "correlated": together.probability if together else np.nan,
                "method": one.method,
                "largest": chance.most if chance else np.nan,
                "remark": _remark(one),
            }
        )
    frame = pd.DataFrame(rows, columns=_COLUMNS)
    times = ccsds.utc_texts(epoch, frame["tca"].to_numpy(float)) if rows else []
    frame["tca"] = np.array(times, dtype=object)
    return frame.sort_values("probability", ascending=False, kind="stable", ignore_index=True)


def text(table: pd.DataFrame) -> str:
    """Return the rows of `table` as aligned text, or NONE."""
    if table.empty:
        return NONE
    formats = dict.fromkeys(("probability", "stated", "correlated", "largest"), "{:.3e}")
    formats |= dict.fromkeys(("miss_m", "r_m", "s_m", "w_m"), "{:.0f}")
    formats |= {"speed_mps": "{:.1f}", "radius_m": "{:g}", "tca": "{:.19}"}
    formatters = {name: form.format for name, form in formats.items()}
    shown = table.drop(columns="stated") if table["stated"].isna().all() else table
    return str(shown.to_string(index=False, na_rep="-", formatters=formatters))


def _remark(conjunction: Conjunction) -> str:
    """Return what to know of a probability: why there is none, or how far it can be trusted."""
    chance, pair = conjunction.chance, (conjunction.first, conjunction.second)
    known = [remark for one in pair for remark in one.remarks]
    if conjunction.is_end:
        known.append("nothing known beyond")
    designators = {one.identity.designator for one in pair}
    if len(designators) == 1 and "" not in designators:
        known.append(f"both have the designator {designators.pop()}: are they one object?")
    if chance is None:
        none = "no covariance" if conjunction.encounter is None else "long encounter: no probability"
        return "; ".join([*known, none])
    unknown = [str(one.identity) for one in pair if one.covariance is None]
    remarks = (
        *((remark, True) for remark in known),
        (f"{', '.join(unknown)} without covariance", bool(unknown)),
        (f"{chance.around:.1e} in its revolution", chance.around > _MORE * chance.probability),
        ("covariance not positive definite", not all(one.is_definite for one in pair)),
        ("covariance inflated", chance.mended),
        ("diluted", chance.is_diluted),
    )
    return "; ".join(remark for remark, holds in remarks if holds)
