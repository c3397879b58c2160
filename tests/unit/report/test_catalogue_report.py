"""The report of a catalogue: one table of all tests, bands and leads."""

import numpy as np
import pandas as pd

from opml.element_sets import corrector_scores
from opml.report.catalogue_pages import scores as catalogue
from opml.report.document import Table, tab_separated

SEASONS = {"summer": {"train": ["2026-03-15", "2026-05-07"], "test": ["2026-05-31", "2026-07-31"]}}


def scores():
    """Scores of two objects in one band by two learners; the second knows no sigma."""
    table = pd.DataFrame(
        {
            "number": [1, 2],
            "morning": 7.0,
            "lead": 3,
            "band": 0,
            "error": [100.0, 300.0],
            "scaled": [80.0, 200.0],
            "learned": [70.0, 150.0],
            "sigma": 60.0,
            "improved": [70.0, 200.0],
            "improved_sigma": 100.0,
            "applied": ["learned", "unchanged"],
            "judge": ["orbit", "set"],
        }
    )
    return pd.concat(
        [
            corrector_scores.scores(part, seed=1).assign(test="summer", learner=learner)
            for learner, part in {"trees": table, "svr": table.assign(sigma=np.nan)}.items()
        ]
    )


def test_the_report_has_a_row_for_each_band_lead_and_learner():
    blocks = catalogue.document(scores(), SEASONS, {"summer": "payloads"})
    (table,) = (block for block in blocks if isinstance(block, Table))
    assert [row[:7] for row in table.rows] == [
        ["summer", height, "3", learner, "2", "2", "1"]
        for height in ("all", "300-400")
        for learner in ("`trees`", "`svr`")
    ]
    first = table.rows[0]
    assert first[7:11] == ["50", "200 / 290", "70 / 67", "55 / 50"]
    assert first[11].startswith("68 (")
    assert first[12:] == ["50", "70 / 55 / 68", "50 / 50 / 50"]
    assert table.rows[1][-1] == "- / 50 / 50"
    assert tab_separated(table).count("\n") == 5


def test_the_report_tells_the_seasons():
    told = str(catalogue.document(scores(), SEASONS, {"summer": "payloads"}))
    assert "**summer**: learned from payloads, 2026-03-15 to 2026-05-07; judged from 2026-05-31 to" in told
