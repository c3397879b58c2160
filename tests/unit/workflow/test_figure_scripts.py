"""Scripts that draw, run in process as Snakemake runs them."""

import runpy
from types import SimpleNamespace

import pandas as pd
from support import REPOSITORY

from opml.learning.judge import rolling_origins
from opml.workflow import jobs


def test_learners_trained_anew_are_drawn_with_the_weather_and_dates(tmp_path, monkeypatch):
    days = pd.DataFrame({"day": [20.0, 21.0], "once": [5.0, 6.0], "anew": [4.0, 5.0]})
    monkeypatch.setattr(jobs, "read_by_key", lambda keys, paths, kind: dict.fromkeys(keys, days))
    monkeypatch.setattr(rolling_origins, "by_day", lambda table: table)
    settings = {
        "epoch": "2019-09-03T00:00:00",
        "rso": "swarm",
        "stations": "eglin",
        "learners": ["mechanism"],
        "every_days": 1.0,
        "last_days": 20.0,
        "weather": "under forecast weather",
    }
    drawn = [tmp_path / "rolling.pdf"], [tmp_path / "rolling.png"]
    snakemake = SimpleNamespace(
        rule="study_rolling",
        log=[str(tmp_path / "log")],
        params=SimpleNamespace(settings=settings),
        input=[],
        output=SimpleNamespace(pdf=drawn[0], png=drawn[1]),
    )
    script = REPOSITORY / "workflow" / "scripts" / "study_rolling.py"
    made = runpy.run_path(str(script), init_globals={"snakemake": snakemake})
    note = made["figure"].legends[0].get_title().get_text()
    assert note == "Swarm A by one radar (Eglin), 20 days to learn from at most\nunder forecast weather"
    assert all(path.stat().st_size > 0 for (path,) in drawn)
