"""Scripts that draw, run in process as Snakemake runs them."""

import json
from datetime import date

from scripts import files, run

from opml.mornings import outcomes, weather_of_day
from opml.mornings.days import failed


def test_a_day_of_many_objects_is_told_drawn_and_listed(tmp_path, monkeypatch):
    monkeypatch.setattr(weather_of_day, "read", lambda files, **_: [])
    told = [failed(f"o{k}", date(2016, 10, 5), "good", "why") for k in range(201)]
    told[0] |= {"height_km": 550.0, "inclination_deg": 53.0}
    told[0] |= {"expected": [{"day": 1, "along_track_sigma_m": 90.0}]}
    outcomes.write(tmp_path / "objects_0.json", told)
    made = files(**{suffix: tmp_path / f"day.{suffix}" for suffix in ("md", "tsv", "html", "json", "png")})
    settings = {"epoch": "2016-09-28T12:09:45", "hour": 6.0, "date": "2016-10-05", "watched": ["o7"]}
    read = files(objects=[tmp_path / "objects_0.json"])
    run("day_of_many", read, made, log=tmp_path / "log", **settings)
    assert len(made.tsv.read_text().splitlines()) == 202
    assert len(json.loads(made.json.read_text())["objects"]) == 201
    assert "**o7. Send: good**" in made.md.read_text()
    assert all(path.stat().st_size > 0 for path in made)
