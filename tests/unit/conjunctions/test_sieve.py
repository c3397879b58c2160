"""Three hundred objects: the sieve finds all that looks every few seconds do, among all and against one."""

import gzip
import io
from collections import Counter
from itertools import chain

import numpy as np
import pandas as pd
import pytest
from support import shared

from opml import cli
from opml.base.constants import EARTH_GM
from opml.conjunctions import screening
from opml.conjunctions.sieve import states_in_teme
from opml.conjunctions.trajectories import read_elements, span_of_days
from opml.interop import oem
from opml.interop.element_sets import element_set, mean_elements, tle
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.interop.object_ids import ObjectId

WITHIN = 5e4
DAYS = 1.5 / 24.0
STEP = 10.0
LIMITS = {"within": WITHIN, "radius": 20.0}


def eccentric(folder, epoch, number):
    """The text of a set with a perigee where most objects are, and an apogee far above."""
    rng = np.random.default_rng(number)
    e = rng.uniform(0.05, 0.75)
    motion = 60.0 * np.sqrt(EARTH_GM / (rng.uniform(6.9e6, 7.3e6) / (1.0 - e)) ** 3)
    angles = rng.uniform(0.0, 6.28, 3)
    made = element_set.satellite(epoch, [motion, e, rng.uniform(0.1, 3.0), *angles, 1e-4])
    tle.write(folder / "one.tle", made, ObjectId("one", f"2025-{number:03d}A", number))
    return (folder / "one.tle").read_text()


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory):
    """A file of 250 objects of a real catalogue, and of 50 on eccentric orbits."""
    lines, folder = {}, tmp_path_factory.mktemp("sieve")
    with gzip.open(shared("real/catalogue/active_2026_daily.tle.gz"), "rt") as file:
        for first, second in zip(file, file, strict=True):
            if first[18:23] <= "26015" and len(lines) < 250:
                lines.setdefault(first[2:7], first + second)
    made = [eccentric(folder, "2026-01-15T00:00:00", k + 1) for k in range(50)]
    path = folder / "catalogue.tle"
    path.write_text("".join([*lines.values(), *made]))
    return path


@pytest.fixture(scope="module")
def looked_at(catalogue):
    """Names of pairs, time and distance where two are nearest, by looks every few seconds at all."""
    begin, end = span = span_of_days(catalogue, DAYS)
    elements = read_elements([catalogue], span)
    t = np.arange(begin, end, STEP)
    states = np.array([states_in_teme(one.known_set, t) for one in elements])
    first, second = np.triu_indices(len(elements), 1)
    found = []
    for k, look in enumerate(t):
        x, v = np.split(states[second, k] - states[first, k], 2, axis=1)
        (near,) = (np.einsum("nk,nk->n", x, x) < (1e-3 * WITHIN + 0.5 * STEP * 20.0) ** 2).nonzero()
        x, v = x[near], v[near]
        ahead = -np.einsum("nk,nk->n", x, v) / np.einsum("nk,nk->n", v, v)
        misses = 1e3 * np.linalg.norm(x + ahead[:, None] * v, axis=1)
        is_now = (ahead >= -0.5 * STEP) & (ahead < 0.5 * STEP)
        for pair, later, miss in zip(near[is_now], ahead[is_now], misses[is_now], strict=True):
            names = frozenset(elements[n[pair]].identity.designator for n in (first, second))
            found.append((names, look + later, miss))
    return found


def told(found):
    """Names of the pair, time and distance of each that is no end of what is known."""
    return [
        (
            frozenset(side.identity.designator for side in (one.first, one.second)),
            one.t,
            np.linalg.norm(one.relative[:3]),
        )
        for one in found
        if not one.is_end
    ]


def missed(sure, found):
    """Those that are near, of which not one is found at their time and distance."""
    return [
        (names, t, miss)
        for names, t, miss in sure
        if miss < WITHIN - 100.0
        and [abs(d - miss) < 60.0 for pair, at, d in found if pair == names and abs(at - t) < 1.0] != [True]
    ]


def test_all_against_all_misses_nothing(catalogue, looked_at):
    found = told(screening.screen_all(catalogue, days=DAYS, **LIMITS))
    assert [t for _, t, _ in found] == sorted(t for _, t, _ in found)
    assert len(found) > 50
    assert missed(looked_at, found) == []
    assert missed(found, looked_at) == []


def test_one_against_all_misses_nothing(catalogue, looked_at, tmp_path):
    ours, _ = Counter(chain(*(names for names, *_ in looked_at))).most_common(1)[0]
    span = span_of_days(catalogue, DAYS)
    (elements,) = (one for one in read_elements([catalogue], span) if one.identity.designator == ours)
    t = np.linspace(*span, 181)
    states = mean_elements.states(elements.known_set.satellite, epoch=EPOCH, t=t)
    oem.write(
        tmp_path / "ours.oem", [Ephemeris("ours", t, states, identity=ObjectId.of("ours", ours))], epoch=EPOCH
    )
    found = told(screening.screen(screening.read([tmp_path / "ours.oem", catalogue]), **LIMITS))
    mine = [one for one in looked_at if ours in one[0]]
    assert len(found) > 3
    assert missed(mine, found) == []
    assert missed(found, mine) == []


def test_the_command_screens_a_catalogue_alone_and_ours_for_days(catalogue, tmp_path, capsys):
    first, second, *rest = catalogue.read_text().splitlines(keepends=True)
    few, ours = tmp_path / "few.tle", tmp_path / "ours.tle"
    few.write_text("".join(rest[-40:]))
    ours.write_text(first + second)
    for files in ([few], [ours, few]):
        arguments = [*map(str, files), "--days", "0.4", "--within", "1500", "--csv"]
        assert cli.main(["screen", *arguments]) == 0
        table = pd.read_csv(io.StringIO(capsys.readouterr().out))
        assert len(table) > 0
        assert table["tca"].is_monotonic_increasing
    assert table["first"].nunique() == 1
