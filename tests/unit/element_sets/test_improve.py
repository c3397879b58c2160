"""Better sets for a morning: nothing later counts, two numbers carry the correction, each set says why."""

import gzip
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from support import refusal

from opml import cli
from opml.base import epochs
from opml.element_sets import (
    catalogue,
    corrector,
    density,
    features,
    improve,
    prediction,
    set_errors,
    trained_model as models,
    weighting,
)
from opml.environment import solar_activity
from opml.interop.element_sets import element_set, mean_elements, omm
from opml.interop.object_ids import ObjectId
from opml.tables import read_table

DATE = "2026-01-08T06:00:00"
"""When 49 sets of each history were public."""

NUMBERS = range(101, 121)
SEEN = 3
"""Lowest band of height that a narrow model was learned from."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sets")
    sinking_histories.write(folder / "known.tle", NUMBERS, 49)
    return folder


@pytest.fixture(scope="module")
def model() -> models.CatalogueModel:
    return models.read()


@pytest.fixture(scope="module")
def better(folder: Path, model: models.CatalogueModel) -> improve.Improved:
    return improve.improve(improve.read([folder], date=DATE, weather="OBSERVED"), model)


def test_mornings_that_the_weather_does_not_reach_have_no_past(
    folder: Path, model: models.CatalogueModel
) -> None:
    known = improve.read([folder], date=DATE, weather="OBSERVED")
    today = epochs.mjd(DATE)
    whole = improve.improve(known, model).past["morning"].min()
    weather = known.weather.drop_before(int(today) - density.RUN_UP - 83 - 10)
    short = improve.improve(replace(known, weather=weather), model)
    assert whole < short.past["morning"].min() == today - 10
    later = replace(known, weather=known.weather.drop_before(int(today) - density.RUN_UP - 82))
    assert "expected measurements 82 days before" in refusal(improve.improve, later, model)


def test_no_later_set_and_no_later_weather_touches_a_morning(
    folder: Path, better: improve.Improved, model: models.CatalogueModel, tmp_path: Path
) -> None:
    """Sets of another future and weather that changes from the date on leave the same bytes."""
    sinking_histories.write(tmp_path / "later.tle", NUMBERS, 60, seed=8)
    later = (tmp_path / "later.tle").read_text().splitlines()[: 2 * 60 * len(NUMBERS)]
    future = [later[k : k + 2] for k in range(0, len(later), 2)]
    future = [pair for pair in future if float(pair[0][20:32]) < 300.0 and pair[0][18:20] == "26"]
    future = [pair for pair in future if float(pair[0][20:32]) > 8.01]
    assert len(future) > 8 * len(NUMBERS)
    (tmp_path / "later.tle").write_text("".join(f"{line}\n" for pair in future for line in pair))
    weather = tmp_path / "weather.csv"
    weather.write_text(_with_storms_after("2026-01-08", solar_activity.resolve("OBSERVED").read_text()))

    known = improve.read([folder, tmp_path / "later.tle"], date=DATE, weather=str(weather))
    again = improve.improve(known, model)

    pd.testing.assert_frame_equal(again.table, better.table, check_exact=True)


def _with_storms_after(day: str, text: str) -> str:
    """Return CSSI's weather with Kp of 9 and a flux of 300 sfu from the day after a date on."""
    lines = []
    for line in text.splitlines():
        cells = line.split(",")
        if cells[0] > day and cells[0][:1] == "2":
            cells[1:9], cells[9] = ["90"] * 8, "300.0"
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("way", [weighting.DENSITY, "learned: payloads"])
def test_sets_flown_by_plain_sgp4_carry_the_correction(
    way: str, folder: Path, model: models.CatalogueModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two numbers come as near to what four leads ask for as least squares does, and the epoch stays."""
    weights = weighting.sole(pd.Series(way, index=[*NUMBERS]))
    monkeypatch.setattr(weighting, "weights", lambda rows, tried: weights)
    known = improve.read([folder], date=DATE, weather="OBSERVED")
    improve.improve(known, model).write(tmp_path / "better.tle")
    old = {one.number: one.satellite for one in mean_elements.read_sets(folder / "known.tle")}
    new = {one.number: one.satellite for one in mean_elements.read_sets(tmp_path / "better.tle")}
    today = epochs.mjd(DATE)
    rows = improve.replayed(known, model, np.arange(-weighting.PAST, 1) + today)
    wanted = weighting.candidates(rows, model.correctors, corrector.jumps(rows))[way]["correction"][
        rows["morning"] == today
    ]

    for number, own in rows.loc[wanted.index].groupby("number"):
        assert new[number].jdsatepochF == old[number].jdsatepochF
        minutes = 1440.0 * own["tau"].to_numpy()
        flown = [element_set.propagate(one[number], minutes) for one in (old, new)]
        taken = set_errors.along_track(flown[0][0], flown[1][0], flown[1][1])
        tau, response, sought = (part.to_numpy() for part in (own["tau"], own["response"], wanted[own.index]))
        design, weight = np.column_stack([tau, response]), tau**-1.5
        nearest = design @ np.linalg.lstsq(design * weight[:, None], sought * weight)[0]
        np.testing.assert_allclose(taken, nearest, atol=10.0 + 0.02 * np.abs(nearest).max())


def test_each_object_says_what_was_done_and_why(
    better: improve.Improved, model: models.CatalogueModel, tmp_path: Path
) -> None:
    assert set(better.table["why"]) == {""}
    assert better.table["number"].tolist() == list(NUMBERS)
    assert better.table["weight"].between(0.25, 1.0).all()  # the heaviest of four ways
    for lead in set_errors.LEADS:
        expected, left = better.table[f"sgp4_{lead}d"], better.table[f"sigma_{lead}d"]
        assert (left > 0.0).all()
        assert (expected >= left).all()

    lines = sinking_histories.sets_of(101, 49)
    cases = {
        "fewer than 3 sets": "\n".join(lines[-4:]),
        "newest set older than 3 d": "\n".join(lines[:80]),
        "no B* above 0": "\n".join(_with_drag(lines, -1e-4)),
        "B* above 0.1": "\n".join(_with_drag(lines, 0.2)),
        "burned lately": "\n".join([*lines[:-2], *_raised(lines[-2:])]),
        improve.SEVERAL: _of_two_objects(tmp_path / "two.tle"),
    }
    for k, (why, text) in enumerate(cases.items()):
        path = tmp_path / f"{k}.tle"
        path.write_text(text + "\n")
        known = improve.read([path], date=DATE, weather="OBSERVED")
        (row,) = improve.improve(known, model).table.itertuples()
        assert row.why == why
        assert row.applied == (weighting.DENSITY if why == "fewer than 3 sets" else weighting.UNCHANGED)


def _of_two_objects(path: Path) -> str:
    """Return sets of two objects under one number, each third day those of the other."""
    sinking_histories.write(path, range(101, 103), 49)
    sets = [one.satellite for one in mean_elements.read_sets(path)]
    mixed = [sets[49 + day] if day % 3 == 0 else sets[day] for day in range(49)]
    return "\n".join(line for one in mixed for line in mean_elements.tle.lines(one, 101))


def test_sets_of_two_objects_are_not_predicted(tmp_path: Path) -> None:
    path = tmp_path / "sets.tle"
    path.write_text(_of_two_objects(path) + "\n")
    assert "have two objects its number?" in refusal(prediction.predict, path, date=DATE)


def test_a_model_is_not_believed_at_heights_that_it_never_saw(
    folder: Path, model: models.CatalogueModel
) -> None:
    """Heights of the lowest two of four kinds of objects are taken away from what taught the model."""

    def above(part: corrector.BandModels) -> corrector.BandModels:
        return replace(part, shares={key: share for key, share in part.shares.items() if key[0] >= SEEN})

    parts = tuple(above(part) for part in model.correctors["payloads"] if max(part.bands) >= SEEN)
    narrow = replace(model, correctors={"payloads": parts})
    table = improve.improve(improve.read([folder], date=DATE, weather="OBSERVED"), narrow).table
    seen = table["height"] >= features.BANDS[SEEN]
    assert seen.any()
    assert not seen.all()
    assert set(table.loc[seen, "why"]) == {""}
    assert set(table.loc[~seen, "why"]) == {improve.UNSEEN}
    assert set(table.loc[~seen, "applied"]) == {weighting.UNCHANGED}
    assert table.loc[~seen, "sigma_7d"].isna().all()
    assert table.loc[seen, "sigma_7d"].notna().all()


def _with_drag(lines: list[str], bstar: float) -> list[str]:
    first, second = lines[-2:]
    motion = float(second[52:63]) * 2.0 * np.pi / 1440.0
    return [*lines[:-2], *mean_elements.tle.with_drag(first, second, motion=motion, bstar=bstar)]


def _raised(pair: list[str]) -> list[str]:
    first, second = pair
    motion = (float(second[52:63]) - 0.02) * 2.0 * np.pi / 1440.0
    return [*mean_elements.tle.with_drag(first, second, motion=motion, bstar=4e-4)]


def test_the_command_writes_sets_and_table(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    table, output = tmp_path / "table.parquet", tmp_path / "better.json"

    code = cli.main(["improve", str(folder), "-o", str(output), "--table", str(table), "--date", DATE])

    assert code == 0
    assert f"{output}: {len(NUMBERS)} sets" in capsys.readouterr().out
    assert len(mean_elements.read_sets(output)) == len(NUMBERS)
    assert read_table(table, "improved_sets")["number"].tolist() == list(NUMBERS)
    code = cli.main(["improve", str(folder), "-o", str(output), "--table", f"{table}.csv", "--date", DATE])
    assert code == 0
    assert len(pd.read_csv(f"{table}.csv")) == len(NUMBERS)


def test_a_folder_without_sets_is_refused(tmp_path: Path) -> None:
    assert "expected files of element sets" in refusal(catalogue.read, [tmp_path])


def test_better_sets_are_not_written_among_those_that_are_read(tmp_path: Path) -> None:
    (tmp_path / "sets").mkdir()
    (tmp_path / "folder.tle").mkdir()
    for better, expected in (
        ("sets/more/b.tle", "a file outside"),
        ("folder.tle", "a file to write, got a f"),
    ):
        paths = [tmp_path / "sets"]
        assert f"{better}: expected {expected}" in refusal(
            improve.check_written, tmp_path / better, None, paths
        )
    improve.check_written(tmp_path / "b.tle", None, paths)
    told = refusal(improve.check_written, tmp_path / "b.tle", tmp_path / "sets" / "t.csv", paths)
    assert "t.csv: expected a file outside" in told


def test_density_of_a_constant_thermosphere_makes_a_parabola() -> None:
    log = np.full((4 * 120, len(density.HEIGHTS)), -28.0)
    air = density.MorningDensity(
        density.Densities(61000, log), np.full((9, len(density.HEIGHTS)), -28.0), 61119.25
    )

    height, after = np.array([455e3]), np.array([[-2.0, -0.3, 1.0, 7.4]])
    found = air.displacement(height, np.array([61118.1]), after)

    np.testing.assert_allclose(found, np.exp(-28.0) * 0.5 * after**2, rtol=1e-6)


def test_own_misses_count_once_their_judge_was_public(folder: Path, model: models.CatalogueModel) -> None:
    """A target of the last days touches no own miss of a morning before its judge."""
    known = improve.read([folder], date=DATE, weather="OBSERVED")
    today = epochs.mjd(DATE)
    rows = improve.replayed(known, model, np.arange(-weighting.PAST, 1) + today)
    changed = rows.assign(target=rows["target"].where(rows["judged"] <= today - 4.0, 99.0))

    before = changed["morning"] <= today - 4.0
    own, other = (features.own_misses(one)[before] for one in (rows, changed))

    pd.testing.assert_frame_equal(own, other, check_exact=True)


def test_a_tenth_of_the_drag_stays_whatever_is_asked(
    folder: Path, model: models.CatalogueModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A correction of twice what drag does along the track would make an orbit rise."""

    def twice(rows: pd.DataFrame, *_: object) -> dict[str, pd.DataFrame]:
        return {
            weighting.DENSITY: pd.DataFrame({"correction": 2e-4 * rows["response"], "sigma": rows["scale"]})
        }

    monkeypatch.setattr(weighting, "candidates", twice)

    table = improve.improve(improve.read([folder], date=DATE, weather="OBSERVED"), model).table

    drag = table.loc[table["bstar_before"] < 2e-4 / 0.9, ["bstar", "bstar_before"]]
    assert len(drag) > 10
    np.testing.assert_allclose(drag["bstar"], 0.1 * drag["bstar_before"], rtol=1e-9)


BAD = {
    "empty.tle": (b"", "got an empty file"),
    "none.csv": (b"No GP data found", "got CelesTrak: no such object"),
    "same.csv": (
        b"GP data has not updated since your last successful download",
        "got CelesTrak: not updated",
    ),
    "page.txt": (b"<!DOCTYPE html><html>busy</html>", "got a web page"),
    "login.json": (b'{"Login":"Failed"}', "got Space-Track: a login that failed"),
    "cut.tle.gz": (gzip.compress(b"1 00101U")[:-8], "expected a file that is whole"),
}


def test_no_bad_file_stops_a_run(tmp_path, capsys, caplog):
    """Five of thirty; more than a quarter of all is refused."""
    gp = tmp_path / "gp"
    gp.mkdir()
    lines = sinking_histories.sets_of(101, 45)
    for k in range(25):
        (gp / f"{k:02d}.tle").write_text("\n".join(lines[2 * k : 2 * k + 42]) + "\n")
    for name, (content, _) in [*BAD.items()][:5]:
        (gp / name).write_bytes(content)
    call = ["improve", str(gp), "-o", str(tmp_path / "better.tle"), "--date", "2026-01-03T06:00:00"]
    assert cli.main(call) == 0
    told = "\n".join(record.message for record in caplog.records)
    capsys.readouterr()
    for name, (_, words) in [*BAD.items()][:5]:
        assert re.search(rf"skipped, a file of 5 in 30: .*{name}: .*{words}", told)
    for path in sorted(gp.glob("[01]*.tle")):
        path.unlink()
    assert cli.main(call) == 1
    assert "cut.tle.gz" not in (refused := capsys.readouterr().err)
    assert any(name in refused.splitlines()[-1] for name in BAD)
    assert refused.endswith("expected at most one in 4 files to be unreadable, got 5 of 10\n")


SATCAT = "OBJECT_NAME,OBJECT_ID,NORAD_CAT_ID,OPS_STATUS_CODE\nSL-1 R/B,1957-001A,1,D\n"


def test_what_belongs_beside_sets_is_passed_over_however_few_they_are(tmp_path, caplog):
    """Sets of operators' ephemerides are told from others by their class."""
    folder = tmp_path / "gp"
    folder.mkdir()
    (folder / "satcat.csv").write_text(SATCAT)
    assert "satcat.csv: expected element sets (TLE, OMM), got a list of" in refusal(catalogue.read, [folder])
    lines = sinking_histories.sets_of(101, 2)
    lines[2] = lines[2].replace("U", "C", 1)
    (folder / "sets.tle").write_text("\n".join(lines) + "\n")
    operators = mean_elements.read_sets(folder / "sets.tle")[1]
    omm.write(
        folder / "b.kvn", operators.satellite, identity=ObjectId("X", number=101), epoch=DATE, comment=""
    )
    (folder / "b.kvn").write_text((folder / "b.kvn").read_text().replace("TYPE = U", "TYPE = C"))
    assert len(catalogue.read([folder]).table) == 3
    assert re.search(r"passed over: .*satcat\.csv: expected .*, got a list of objects", caplog.text)
    for name in ("sets.tle", "b.kvn"):
        assert f"{name}: sets of operators' ephemerides: 1: burns to come are in them" in caplog.text


@pytest.mark.parametrize(("days", "is_told"), [(1, False), (10, True)])
def test_dates_of_creation_that_are_of_a_download_are_told(days, is_told, tmp_path, caplog):
    """No past is known of sets that all came today."""
    text = ""
    for day in range(4):
        path = tmp_path / f"{day}.kvn"
        epoch = str(np.datetime64("2026-01-01T00:00:00") + np.timedelta64(day, "D"))
        made = element_set.satellite(epoch, [0.0666, 1e-3, 1.0, 1.0, 1.0, 1.0, 1e-4])
        omm.write(path, made, identity=ObjectId("X", number=5), epoch=epoch, comment="")
        created = str(np.datetime64(epoch) + np.timedelta64(days * (day != 3), "D"))
        text += re.sub("(?<=CREATION_DATE = ).*", created, path.read_text())
    (tmp_path / "all.kvn").write_text(text)
    assert len(catalogue.read([tmp_path / "all.kvn"]).table) == 4
    told = "element sets made more than 3 d after their epochs: 3 of 4: is CREATION_DATE a download's?"
    assert (told in caplog.text) == is_told


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_alone_is_told_in_a_line(name, tmp_path, capsys):
    content, words = BAD[name]
    (tmp_path / name).write_bytes(content)
    assert cli.main(["predict", str(tmp_path / name)]) == 1
    assert re.fullmatch(rf"opml: .*{name}: .*{words}.*\n", capsys.readouterr().err)
