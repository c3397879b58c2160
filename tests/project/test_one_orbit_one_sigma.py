"""The commands say one thing of an object: the same model, states and sigmas from the same sets at a time."""

import csv
from importlib import resources
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from sgp4 import exporter
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.constants import DAY
from opml.benchmark import baselines
from opml.conjunctions import screening
from opml.element_sets import prediction
from opml.element_sets.inside import inside_now
from opml.interop.element_sets import known_sets
from opml.interop.ephemeris import EPOCH
from opml.mornings import set_mornings
from opml.mornings.records import Records
from opml.mornings.watched_object import MorningPlan

NUMBERS = range(101, 111)
DATE = "2026-01-07T05:00:00"
SIGMAS = ("along_track_sigma_m", "radial_sigma_m", "cross_track_sigma_m")


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    """Ten objects, a file each, a set a day for seven weeks, that say when they were made."""
    folder = tmp_path_factory.mktemp("sets")
    return [written(folder / f"{number}.csv", number) for number in NUMBERS]


def written(path, number):
    lines = sinking_histories.sets_of(number, 49)
    rows = []
    for first, second in zip(lines[::2], lines[1::2], strict=True):
        satellite = Satrec.twoline2rv(first, second)
        satellite.intldesg = "98067A"
        row = exporter.export_omm(satellite, str(number))
        rows.append(row | {"CREATION_DATE": f"{row['EPOCH'][:11]}05:00:00"})
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    return path


@pytest.fixture(scope="module", autouse=True)
def sought_once():
    """Orbits inside sets under a coarse field; those of the same sets and date are sought once."""
    find, remembered_orbits = inside_now.find, {}

    def remembered(public, *, date, forces, kept=None):
        sets = tuple((one.t, one.made, one.satellite.bstar, one.satellite.mo) for one in public)
        if (sets, date[:19]) not in remembered_orbits:
            remembered_orbits[sets, date[:19]] = find(public, date=date, forces=forces)
        return remembered_orbits[sets, date[:19]]

    with pytest.MonkeyPatch.context() as patch:
        sinking_histories.seek_coarsely(patch.setattr)
        patch.setattr(inside_now, "find", remembered)
        yield


@pytest.fixture(scope="module")
def predicted(paths):
    """Each object beside the others."""
    morning = prediction.PublicMorning.read(paths, date=f"{DATE}Z", weather="OBSERVED")
    return [morning.predict(*known_sets.by_object([path]).values()) for path in paths]


def test_predict_begins_when_the_newest_set_was_known(paths, predicted):
    first, *others = paths
    made = prediction.predict(first, catalogue=others)
    assert (made.date, made.way) == (DATE, predicted[0].way)
    np.testing.assert_array_equal(made.sizes, predicted[0].sizes)
    np.testing.assert_array_equal(made.states(made.t[::60]), predicted[0].states(made.t[::60]))


def test_screen_says_what_predict_says(paths, predicted):
    start, t = epochs.seconds_between(EPOCH, DATE), np.array([1.0, 3.0, 6.8]) * DAY
    for made, one in zip(predicted, screening.read(paths), strict=True):
        (trajectory,) = one.trajectories
        assert made.way in trajectory.remark
        np.testing.assert_allclose(trajectory.at(start + t)[:, :3], made.states(t)[:, :3], atol=1e-2)
        held = trajectory.covariances_at(start + t)
        sizes = np.sqrt(np.diagonal(held, axis1=1, axis2=2))[:, :3]
        np.testing.assert_allclose(sizes, made.sigmas(t), rtol=1e-3)


def test_day_says_what_predict_says(paths, predicted):
    """A study of public sets is a replay of the day."""
    plan = MorningPlan({}, None, 7.0, 60.0, 10 * DAY, DATE)
    sets = set_mornings.read(paths, "OBSERVED", since=epochs.mjd(DATE))
    days = np.arange(1.0, 8.0)
    for path, made in zip(paths, predicted, strict=True):
        (history,) = known_sets.by_object([path]).values()
        left = set_mornings.of_sets(plan, sets, history).morning(Records.empty(), 0.0)
        assert left.records.issued["model"].iloc[0] == made.model
        told = [[one[name] for name in SIGMAS] for one in left.figures["expected"]]
        np.testing.assert_allclose(told, made.sigmas(DAY * days)[:, [1, 0, 2]], atol=0.051)


def test_answer_says_what_predict_says(paths, predicted, tmp_path):
    lines = [path.read_text().splitlines() for path in paths]
    (tmp_path / "sets.tle").write_text("\n".join([lines[0][0], *(row for one in lines for row in one[1:])]))
    (tmp_path / "weather.csv").symlink_to(str(resources.files("opml") / "data" / "space_weather.csv"))
    task, when = SimpleNamespace(inputs=lambda t: tmp_path, latency=0.25), "2026-01-12T05:00:00"
    questions = pd.DataFrame({"object": NUMBERS, "t": DATE, "time": when})
    for made, row in zip(predicted, baselines._predicted(task, DATE, questions, None), strict=True):
        np.testing.assert_allclose(np.array(row[4:10], float), made.state(when), atol=1e-5)
        trace = sum(float(row[k]) for k in (10, 13, 15))
        assert trace == pytest.approx(np.trace(made.covariance(when)[:3, :3]), rel=1e-6)
