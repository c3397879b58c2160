"""Alarms of public sets: who knows what the density does to both objects flags more collisions."""

import numpy as np
import pandas as pd

from validation import alarms


def test_what_objects_share_flags_more_collisions(monkeypatch):
    monkeypatch.setattr("opml.conjunctions.collision_alarms._DRAWS", 256)
    monkeypatch.setattr("opml.conjunctions.collision_alarms._AREAS", 16)
    rng, objects = np.random.default_rng(1), np.arange(40)
    rows = [
        pd.DataFrame(
            {"number": objects, "morning": 61000.0 + day, "lead": lead, "band": 3, "error": late + own}
        )
        for day in range(30)
        for lead in alarms.LEADS
        for late, own in [(3000.0 * lead * rng.normal(), 300.0 * rng.normal(size=40))]
    ]
    residuals = pd.concat(rows, ignore_index=True)
    residuals = residuals.assign(improved=0.8 * residuals["error"], improved_sigma=2400.0 * residuals["lead"])
    monkeypatch.setattr(alarms, "HEIGHTS", {"all": [3]})
    table = alarms.table(residuals)
    np.testing.assert_allclose(table["per_approach"], 4e-4 * table["alarms"])
    flagged = table["flagged"].xs("any", level="crossing").droplevel("height")
    assert list(flagged.index) == [
        f"{name}, {case}" for name in ("SGP4", "improved") for case in ("independent", "shared")
    ]
    for name in ("SGP4", "improved"):
        assert (
            flagged.loc[f"{name}, shared", [5.0, 7.0]] > flagged.loc[f"{name}, independent", [5.0, 7.0]]
        ).all()
