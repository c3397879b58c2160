"""Scripts that draw, run in process as Snakemake runs them."""

import json
from datetime import date

from mornings import replays
from scripts import files, run

from opml.learning.judge.error_sizes import as_known
from opml.mornings import outcomes, weather_of_day
from opml.mornings.days import failed
from opml.tables import POSITION_COVARIANCES, SCHEMAS, read_table, write_table


def test_conjunctions_of_a_study_are_told_and_drawn(tmp_path, monkeypatch):
    for number, few in (("_DRAWS", 128), ("_AREAS", 32)):
        monkeypatch.setattr(f"opml.conjunctions.collision_alarms.{number}", few)
    past = replays(days=20)
    for name, larger in (("none", 9.0), ("running", 1.0)):
        stated = as_known(past, past["morning"].to_numpy())
        table = stated.assign(e_y=larger * past["e_y"], before=9.0 * past["e_y"])
        write_table(tmp_path / name, table[SCHEMAS["replay"].names], "replay", metadata={})
    fits = past[["i", "j"]].assign(**dict.fromkeys(POSITION_COVARIANCES, 1.0))
    write_table(tmp_path / "fits", fits, "covariances", metadata={})
    settings = {"learners": ["none", "running"], "laws": [], "seed": 1, "days": [1.0], "note": "a note"}
    settings |= {"epoch": "2019-09-03T00:00:00", "radius_m": 20.0, "threshold": 1e-4, "weather": "forecast"}
    told, drawn = tmp_path / "told", files(pdf=[tmp_path / "c.pdf"], png=[tmp_path / "c.png"])
    read = files(
        replays=[tmp_path / "none", tmp_path / "running"], judge=[], fits=tmp_path / "fits", beside=[]
    )
    run("conjunctions", read, [told], log=tmp_path / "log", **settings)
    run("study_conjunctions", [told], drawn, log=tmp_path / "log", **settings)
    table = read_table(told, "conjunctions")
    assert set(table["weather"]) == {"forecast"}
    models = table.loc[table["crossing"] == "any", "model"]
    assert models.tolist() == ["none", "none", "running", "selected each day"]
    assert all(path.stat().st_size > 0 for path in (*drawn.pdf, *drawn.png))


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
