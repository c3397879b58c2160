"""The lines that `opml improve` prints of a catalogue."""

import numpy as np
import pandas as pd

from opml.element_sets import improved_summary


def table(rows):
    """Rows of height [km], what was applied, why, and the size of SGP4's errors after a day, as a table."""
    height, applied, why, size = map(np.array, zip(*rows, strict=True))
    sizes = {f"sgp4_{lead}d": lead * size for lead in (1, 7)}
    halves = {f"sigma_{lead}d": 0.5 * lead * size for lead in (1, 7)}
    return pd.DataFrame({"height": 1e3 * height, "applied": applied, "why": why, **sizes, **halves})


def test_objects_are_counted_and_their_errors_told_by_height():
    rows = [(310.0, "learned", "", size) for size in (100.0, 300.0, 800.0)]
    rows += [(650.0, "density", "fewer than 3 sets", 40.0), (650.0, "unchanged", "", 20.0)]
    rows += [(36e3, "unchanged", "deep space", np.nan)] * 2
    counts, _, heads, low, high = improved_summary.text(table(rows)).splitlines()
    reasons = "deep space: 2, no gain on its last mornings: 1"
    assert (
        counts
        == f"7 objects, corrected along the track: 3 learned, 3 unchanged, 1 density; reasons: {reasons}"
    )
    assert heads.split("  ")[0] == "height [km]"
    assert low.split() == ["300-400", "3", "300", "150", "2100", "1050"]
    assert high.split() == ["600-700", "2", "30", "15", "210", "105"]


def test_without_errors_there_are_counts_alone():
    rows = [(36e3, "unchanged", "deep space", np.nan)]
    counts = "1 object, corrected along the track: 1 unchanged; reasons: deep space: 1"
    assert improved_summary.text(table(rows)) == counts
