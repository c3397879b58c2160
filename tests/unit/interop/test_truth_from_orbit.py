"""Real orbits in the truth's place: every format gives the orbit back, and what is broken is told."""

import json
from functools import cache

import erfa
import numpy as np
import orbit_files
import pandas as pd
import pytest
from damage import DAMAGES, damaged
from hypothesis import given
from support import EPOCH, force_model, shared

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.environment import earth_orientation as eop
from opml.interop import ccsds, oem, orbit_from_files, truth_from_orbit
from opml.interop.curves import orbit_curve
from opml.interop.ephemeris import Ephemeris
from opml.interop.orbit_arcs import contents
from opml.interop.orbit_formats import sp3
from opml.interop.orbit_from_files import OrbitFiles
from opml.tables import STATE

STEP = 5.0
DURATION = 14400.0
BIAS = ccsds.FRAMES["EME2000"].T  # GCRF to EME2000


@pytest.fixture(scope="module")
def orbit(iss):
    """Five hours of the paper's RSO every 5 s under all forces, gravity to degree 70: times and states."""
    table = truth.simulate(Propagator(force_model(70), iss), duration=18000.0, step=STEP)
    return table["t"].to_numpy(), table[STATE].to_numpy()


@pytest.fixture(scope="module")
def nodes(orbit, earth_orientation):
    """The orbit in ITRF at a cadence [s], from a time [s]."""

    def cut(cadence, start=0.0, end=18000.0):
        kept = (orbit[0] >= start) & (orbit[0] <= end) & ((orbit[0] - start) % cadence == 0.0)
        t, states = orbit[0][kept], orbit[1][kept]
        return t, orbit_files.in_itrf(states, t, earth_orientation)

    return cut


@pytest.fixture(scope="module")
def attraction(earth_orientation):
    return orbit_files.attraction_of(earth_orientation)


@pytest.fixture(scope="module")
def deviations(orbit):
    """How far a truth table is off the orbit, row by row (n, 6) [m, m/s]."""
    return lambda table: table[STATE].to_numpy() - orbit[1][np.rint(table["t"].to_numpy() / STEP).astype(int)]


def worst(off):
    """Largest deviation of a position [m]."""
    return np.linalg.norm(off[:, :3], axis=1).max()


def in_eme2000(orbit, cadence, start=0.0):
    """Times and states of an orbit in EME2000."""
    kept = (orbit[0] >= start) & ((orbit[0] - start) % cadence == 0.0)
    return orbit[0][kept], orbit[1][kept] @ np.kron(np.eye(2), BIAS).T


def read_truth(paths, *, epoch=EPOCH, duration=DURATION, satellite=None, **limit):
    """The truth of files every 20 s, and the facts about it."""
    return truth_from_orbit.truth(OrbitFiles(paths, epoch, duration, satellite), step=20.0, **limit)


WRITERS = {
    "sp3": lambda path, orbit, nodes: orbit_files.sp3(path, *nodes(60.0, 5.0)),
    "sp3.gz": lambda path, orbit, nodes: orbit_files.sp3(path, *nodes(300.0, 5.0), scale="TAI", version="d"),
    "positions.sp3": lambda path, orbit, nodes: orbit_files.sp3(path, *nodes(60.0, 5.0), velocities=False),
    "cpf": lambda path, orbit, nodes: orbit_files.cpf(path, *nodes(180.0, 5.0)),
    "cpf.gz": lambda path, orbit, nodes: orbit_files.cpf(path, *nodes(300.0), version=2, velocities=True),
    "oem": lambda path, orbit, nodes: orbit_files.oem(path, [in_eme2000(orbit, 240.0, 5.0)]),
    "oem.gz": lambda path, orbit, nodes: orbit_files.oem(
        path, [nodes(240.0, 5.0)], frame="ITRF-97", scale="GPS"
    ),
}


@pytest.mark.parametrize("kind", WRITERS)
def test_every_format_gives_the_orbit_back(tmp_path, orbit, nodes, deviations, kind):
    path = WRITERS[kind](tmp_path / f"orbit.{kind}", orbit, nodes)
    table, facts = read_truth([path])
    assert table["t"].tolist() == np.arange(20.0 if table["t"][0] else 0.0, 14401.0, 20.0).tolist()
    assert worst(deviations(table)) < 0.02
    assert np.abs(deviations(table)[:, 3:]).max() < 0.001
    assert facts["interpolation_error_m"]["rms"] < 0.1
    assert (facts["seams"], facts["manoeuvres"], facts["positions_left_out"]) == ([], [], 0)
    assert json.loads(json.dumps(facts)) == facts
    orbit_from_files.read_arcs(OrbitFiles([path], EPOCH, DURATION))


def test_an_oem_on_the_grid_comes_through_bit_for_bit(tmp_path, orbit):
    frame = pd.DataFrame({"t": orbit[0][::4], **dict(zip(STATE, orbit[1][::4].T, strict=True))})
    oem.write(tmp_path / "iss.oem", oem.truth_segments(frame, rso="iss"), epoch=EPOCH)
    table, _ = read_truth([tmp_path / "iss.oem"], duration=18000.0)
    pd.testing.assert_frame_equal(table, frame, check_exact=True)


def independent(t, position):
    """GCRF positions (n, 3) of ITRF ones, by ERFA's own steps and a straight line through the bulletin."""
    daily = eop.read_finals2000a(eop.astropy_iers_data.IERS_A_FILE)
    day, part = epochs.utc(EPOCH, t)
    mjd = (day - epochs.MJD_ZERO) + part
    x_pole, y_pole, dx, dy, ut1 = (
        np.interp(mjd, daily["mjd"], daily[name]) for name in ("x_pole", "y_pole", "dx", "dy", "ut1_utc")
    )
    tt = epochs.tt(EPOCH, t)
    x, y, _ = erfa.xys06a(*tt)
    celestial = erfa.c2ixys(x + dx, y + dy, erfa.s06(*tt, x + dx, y + dy))
    polar = erfa.pom00(x_pole, y_pole, erfa.sp00(*tt))
    turn = erfa.c2tcio(celestial, erfa.era00(day, part + ut1 / DAY), polar)
    return np.einsum("nji,nj->ni", turn, position)


def test_itrf_is_turned_as_erfa_turns_it(tmp_path, nodes, earth_orientation):
    path = orbit_files.sp3(tmp_path / "orbit.sp3", *nodes(60.0))
    (arc,) = sp3.read(path, contents(path), epoch=EPOCH)
    states = orbit_curve.rotate_to_gcrf(arc, earth_orientation)
    off = np.linalg.norm(states[:, :3] - independent(arc.t, arc.positions), axis=1)
    assert off.max() < 0.01


def test_rows_without_an_orbit_are_absent(tmp_path, nodes, deviations):
    t, states = nodes(60.0, 5.0, 12000.0)
    kept = (t < 4000.0) | (t > 4400.0)
    table, facts = read_truth([orbit_files.sp3(tmp_path / "orbit.sp3", t[kept], states[kept])])
    absent = sorted(set(np.arange(0.0, 14401.0, 20.0)) - set(table["t"]))
    assert absent == [0.0, *np.arange(3980.0, 4441.0, 20.0), *np.arange(11960.0, 14401.0, 20.0)]
    assert facts["gaps"] == [[0.0, 20.0], [3960.0, 4460.0], [11940.0, 14400.0]]
    assert worst(deviations(table)) < 0.01


def test_files_that_abut_are_one_orbit_in_any_order(tmp_path, nodes, deviations):
    first = orbit_files.sp3(tmp_path / "a.sp3", *nodes(60.0, 0.0, 7140.0))
    second = orbit_files.sp3(tmp_path / "b.sp3", *nodes(60.0, 7200.0))
    both = orbit_files.sp3(tmp_path / "both.sp3", *nodes(60.0))
    table, facts = read_truth([second, first])
    whole, _ = read_truth([both])
    pd.testing.assert_frame_equal(table, whole, check_exact=True)
    assert facts["files"] == ["a.sp3", "b.sp3"]


def moved(states, by):
    """States (n, 6) with their positions moved by (3,) [m]."""
    return states + np.append(by, np.zeros(3))


def test_nothing_is_bridged_over_a_seam(tmp_path, nodes, deviations):
    first = orbit_files.cpf(tmp_path / "a.cpf", *nodes(180.0, 0.0, 7199.0))
    t, states = nodes(180.0, 7200.0)
    second = orbit_files.cpf(tmp_path / "b.cpf", t, moved(states, [0.0, 14.0, 0.0]))
    table, facts = read_truth([first, second])
    assert [seam["t"] for seam in facts["seams"]] == [7110.0]
    assert facts["seams"][0]["step_m"] == pytest.approx(14.0, rel=0.02)
    assert facts["gaps"] == [[7020.0, 7200.0]]
    before = (table["t"] < 7100.0).to_numpy()
    assert worst(deviations(table)[before]) < 0.05
    np.testing.assert_allclose(np.linalg.norm(deviations(table)[~before, :3], axis=1), 14.0, rtol=0, atol=0.1)


def test_where_files_overlap_the_one_that_begins_later_counts(tmp_path, nodes, deviations):
    first = orbit_files.sp3(tmp_path / "a.sp3", *nodes(60.0, 0.0, 10000.0))
    t, states = nodes(60.0, 7205.0)
    second = orbit_files.sp3(tmp_path / "b.sp3", t, moved(states, [3.0, 0.0, 4.0]))
    table, facts = read_truth([first, second])
    assert facts["gaps"] == []
    assert facts["seams"] == [{"t": 7220.0, "step_m": pytest.approx(5.0, rel=1e-3)}]
    size = np.linalg.norm(deviations(table)[:, :3], axis=1)
    np.testing.assert_allclose(size, np.where(table["t"] < 7205.0, 0.0, 5.0), rtol=0, atol=0.02)


def test_a_burn_that_a_file_marks_is_one_however_small(tmp_path, nodes, deviations):
    path = orbit_files.sp3(tmp_path / "orbit.sp3", *nodes(60.0), velocities=False)
    table, facts = read_truth([orbit_files.flagged(path, 22 + 2 * 100 + 1, "M", 78)])
    assert facts["manoeuvres"] == [{"t": 5970.0}]
    assert worst(deviations(table)) < 0.02


def burn(orbit, attraction, start, length, size):
    """Times and states: every 240 s before a burn, every 2 s within it, every 240 s after it."""
    coarse = np.arange(0.0, start, 240.0)
    dense = np.arange(start, start + length, 2.0)
    later = np.arange(start + length, 18000.0, 240.0)

    def thrust(t):
        return size / length * np.array([0.6, 0.0, 0.8])

    parts = [orbit_files.flown(attraction, orbit[1][0], np.append(coarse, start))]
    parts.append(orbit_files.flown(attraction, parts[0][-1], np.append(dense, start + length), thrust))
    parts.append(orbit_files.flown(attraction, parts[1][-1], later))
    states = np.concatenate([parts[0][:-1], parts[1][:-1], parts[2]])
    return np.concatenate([coarse, dense, later]), states


def test_a_burn_is_told_with_its_size_and_stays_in_the_orbit(tmp_path, orbit, attraction):
    t, states = burn(orbit, attraction, 7200.0, 600.0, 1.7)
    path = orbit_files.oem(tmp_path / "iss.oem", [(t, states)], frame="GCRF")
    table, facts = read_truth([path])
    assert facts["manoeuvres"] == [{"t": pytest.approx(7500.0), "dv_mps": pytest.approx(1.7, rel=0.005)}]
    assert (facts["gaps"], facts["seams"]) == ([], [])
    within = table[(table["t"] > 7200.0) & (table["t"] < 7800.0)]
    np.testing.assert_allclose(within[STATE], states[np.isin(t, within["t"])], rtol=0, atol=1e-6)
    # Just before and after it, no row feels the burn of the other side.
    for start, first, end in ((6960.0, 6960.0, 7200.0), (7800.0, 7800.0, 8040.0)):
        rows = table[(table["t"] >= first) & (table["t"] <= end)]
        flown = orbit_files.flown(attraction, states[t == start][0], rows["t"].to_numpy())
        np.testing.assert_allclose(rows[["x", "y", "z"]], flown[:, :3], rtol=0, atol=0.01)


def test_a_wrong_position_is_left_out_and_named(tmp_path, nodes, deviations, caplog):
    t, states = nodes(60.0, 5.0)
    states[100, :3] += 1000.0
    path = orbit_files.sp3(tmp_path / "orbit.sp3", t, states)
    with caplog.at_level("WARNING", "opml"):
        table, facts = read_truth([path])
    assert facts["positions_left_out"] == 1
    assert facts["gaps"][1:] == [[5940.0, 6080.0]]
    assert f"{path}: line {23 + 3 * 100 + 1}: left out" in caplog.text
    assert worst(deviations(table)) < 0.01


def test_a_wrong_velocity_is_left_out(tmp_path, nodes, deviations):
    t, states = nodes(60.0)
    states[100, 3] += 5.0
    table, facts = read_truth([orbit_files.sp3(tmp_path / "orbit.sp3", t, states)])
    assert facts["velocities_left_out"] == 1
    assert worst(deviations(table)) < 0.01
    assert np.abs(deviations(table)[:, 3:]).max() < 0.01


def test_velocities_that_tell_less_than_the_positions_are_left_out(tmp_path, nodes, deviations):
    t, states = nodes(180.0)
    states[:, 3:] += np.random.default_rng(1).normal(0.0, 0.02, (len(t), 3))
    table, facts = read_truth([orbit_files.sp3(tmp_path / "orbit.sp3", t, states)])
    assert facts["velocities_left_out"] == len(t)
    assert worst(deviations(table)) < 0.05
    assert np.abs(deviations(table)[:, 3:]).max() < 0.002


def test_velocities_in_another_unit_are_refused(tmp_path, nodes):
    t, states = nodes(60.0)
    states[:, 3:] *= 10.0
    path = orbit_files.sp3(tmp_path / "orbit.sp3", t, states)
    with pytest.raises(InputError, match=r"expected velocities that fit the positions, got .*unit"):
        read_truth([path])


@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_positions_in_another_unit_are_refused(tmp_path, nodes, factor):
    t, states = nodes(60.0)
    path = tmp_path / "a.oem"
    oem.write(path, [Ephemeris("mine", t, factor * states)], epoch=EPOCH)
    with pytest.raises(
        InputError, match=r"a\.oem: line \d+: expected positions 6357 to 600000 km .*unit right"
    ):
        orbit_from_files.read_arcs(OrbitFiles([path], EPOCH, DURATION))


def test_an_orbit_that_is_too_rough_is_refused(tmp_path, nodes):
    t, states = nodes(180.0)
    states[:, :3] += np.random.default_rng(1).normal(0.0, 10.0, (len(t), 3))
    path = orbit_files.cpf(tmp_path / "orbit.cpf", t, states)
    with pytest.raises(InputError, match=r"orbit.cpf: expected nodes that predict each other to 3 m, got 1"):
        read_truth([path])
    table, facts = read_truth([path], limit=100.0)
    assert 5.0 < facts["interpolation_error_m"]["rms"] < 50.0
    assert len(table) == 721


def test_another_orbit_is_no_seam(tmp_path, nodes):
    first = orbit_files.sp3(tmp_path / "a.sp3", *nodes(60.0, 0.0, 7140.0))
    t, states = nodes(60.0, 7200.0)
    second = orbit_files.sp3(tmp_path / "b.sp3", t, moved(states, [0.0, 5e4, 0.0]))
    with pytest.raises(InputError, match=r"expected one orbit, got a step of 50 km at 2016-09-28T14:09:15"):
        read_truth([first, second])


REFUSED = {
    "none": "a.sp3: no such file",
    "text": r"b.txt: expected an orbit .OEM, SP3, CPF, modified ITC, STK, CSV of points., got 'x'",
    "format": r"b.cpf: expected SP3, as .*a.sp3, got CPF",
    "satellite": r"b.sp3: expected satellite L47, as in .*a.sp3, got L48",
    "scale": r"b.sp3: expected time system GPS, as in .*a.sp3, got UTC",
    "frame": r"b.oem: expected frame GCRF, as in .*a.oem, got ITRF",
    "start": r"b.sp3: expected another beginning than that of .*a.sp3, got the same",
    "run": r"a.sp3: expected an orbit between 2016-09-29T12:09:45 and 0.\d+ days later, got one from 2016",
    "spacing": r"a.sp3: expected positions at most 300 s apart, got 600 s",
}


@pytest.fixture
def unfit(tmp_path, orbit, nodes):
    """Files that no truth can be made of, and the epoch of the run, by what is wrong."""
    first, second = nodes(60.0, 0.0, 7140.0), nodes(60.0, 7200.0)

    def a(name="a.sp3", orbit=first, **how):
        return orbit_files.sp3(tmp_path / name, *orbit, **how)

    made = {
        "none": lambda: [tmp_path / "a.sp3"],
        "text": lambda: [a(), (tmp_path / "b.txt").write_text("x") and tmp_path / "b.txt"],
        "format": lambda: [a(), orbit_files.cpf(tmp_path / "b.cpf", *second)],
        "satellite": lambda: [a(), a("b.sp3", second, satellite="L48")],
        "scale": lambda: [a(), a("b.sp3", second, scale="UTC")],
        "frame": lambda: [
            orbit_files.oem(tmp_path / "a.oem", [first], frame="GCRF"),
            orbit_files.oem(tmp_path / "b.oem", [second], frame="ITRF2014"),
        ],
        "start": lambda: [a(), a("b.sp3")],
        "run": lambda: [a()],
        "spacing": lambda: [a(orbit=nodes(600.0))],
    }
    return lambda what: (made[what](), EPOCH if what != "run" else "2016-09-29T12:09:45")


@pytest.mark.parametrize("what", REFUSED)
def test_what_does_not_fit_is_told_before_alike(unfit, what):
    paths, epoch = unfit(what)
    with pytest.raises(InputError, match=REFUSED[what]) as checked:
        orbit_from_files.read_arcs(OrbitFiles(paths, epoch, DURATION))
    with pytest.raises(InputError) as read:
        read_truth(paths, epoch=epoch)
    assert str(checked.value) == str(read.value)
    assert "\n" not in str(checked.value)


@pytest.fixture(scope="module")
def sound(tmp_path_factory, orbit, nodes):
    """A folder, and the bytes of a sound file of each format, two hours long."""
    folder = tmp_path_factory.mktemp("damaged")
    t, states = in_eme2000(orbit, 120.0)
    return folder, {
        "sp3": orbit_files.sp3(folder / "x.sp3", *nodes(60.0, 0.0, 7200.0)).read_bytes(),
        "cpf": orbit_files.cpf(folder / "x.cpf", *nodes(120.0, 0.0, 7200.0)).read_bytes(),
        "oem": orbit_files.oem(folder / "x.oem", [(t[:61], states[:61])]).read_bytes(),
    }


def refusal(path):
    """What is told of a file that is refused, or else its truth table."""
    try:
        return read_truth([path], duration=7200.0)[0]
    except InputError as error:
        return str(error)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["sp3", "cpf", "oem"])
@given(damage=DAMAGES)
def test_a_damaged_file_is_refused_in_one_line_or_gives_the_right_orbit(sound, deviations, kind, damage):
    folder, contents_of = sound
    path = folder / f"damaged.{kind}"
    path.write_bytes(damaged(contents_of[kind], *damage))
    result = refusal(path)
    if isinstance(result, str):
        assert path.name in result
        assert "\n" not in result
    else:
        assert worst(deviations(result)) < 3.0


# Files as their services issue them: epoch and days of a run, and the error of the interpolation [m].
REAL = {
    "swarm": ("swarm_a_2019-09/*__2019092*", "2019-09-21T00:00:00", 10.0, 1e-3),
    "sentinel": ("sp3/ssas3a20.*", "2018-12-24T22:00:00", 9.0, 1e-3),
    "lageos2": ("sp3/ilrsa.*", "2016-03-13T00:00:07", 6.9, 2e-3),
    "stella": ("sp3/nsgf.*", "2023-12-08T00:00:05", 0.2, 0.01),
    "larets": ("cpf/larets*", "2022-07-04T12:00:00", 60.0, 0.01),
    "jason3": ("cpf/jason3*", "2018-06-13T00:00:10", 4.9, 0.02),
    "lageos1": ("cpf/lageos1*", "2018-06-13T00:00:00", 1.9, 0.005),
    "iss_2023_02": ("oem/iss_2023-02*", "2023-02-15T12:00:00", 15.0, 0.05),
    "iss_2023_09": ("oem/iss_2023-09*", "2023-09-15T12:00:00", 15.0, 0.05),
    # The times of its last seven hours are rounded to the millisecond: 4 m along the track, to and fro.
    "iss_2024_05": ("oem/iss_2024-05*", "2024-05-31T12:00:00", 15.0, 1.1),
}


@pytest.fixture(scope="module")
def real():
    """Truth table of a real orbit, and what is told of it."""

    @cache
    def read(name):
        pattern, epoch, days, _ = REAL[name]
        paths = sorted(shared("real").glob(pattern))
        files = OrbitFiles(paths, epoch, days * DAY)
        orbit_from_files.read_arcs(files)
        return truth_from_orbit.truth(files, step=20.0)

    return read


@pytest.mark.slow
@pytest.mark.parametrize("name", REAL)
def test_a_real_orbit_is_read(real, name):
    table, facts = real(name)
    assert facts["interpolation_error_m"]["rms"] < REAL[name][3]
    assert facts["positions_left_out"] == 0
    assert len(table) > 0.998 * REAL[name][2] * DAY / 20.0
    speed, distance = (np.linalg.norm(table[axes], axis=1) for axes in (STATE[3:], STATE[:3]))
    energy = 0.5 * speed**2 - 3.986004415e14 / distance
    # Gravity beyond its central term moves the energy of a low orbit by some thousandths, no more.
    assert np.abs(energy / energy.mean() - 1.0).max() < 5e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "announced"), [("iss_2023_02", [1.7]), ("iss_2023_09", [0.7]), ("iss_2024_05", [1.1, 1.4])]
)
def test_the_burns_of_the_iss_are_those_that_nasa_announces(real, name, announced):
    sizes = [manoeuvre["dv_mps"] for manoeuvre in real(name)[1]["manoeuvres"]]
    assert sizes == pytest.approx(announced, abs=0.05)  # announced to 0.1 m/s


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in REAL if not name.startswith("iss")])
def test_no_manoeuvre_is_told_of_a_satellite_that_made_none(real, name):
    assert real(name)[1]["manoeuvres"] == []


@pytest.mark.slow
def test_the_days_of_swarm_are_joined_and_its_one_break_is_told(real):
    facts = real("swarm")[1]
    (seam,) = facts["seams"]
    assert seam["t"] == pytest.approx(821177.0, abs=10.0)  # 2019-09-30T12:06
    assert seam["step_m"] == pytest.approx(0.08, abs=0.01)
    # GPS time is ahead of UTC, so the last seconds of the last day are missing.
    assert facts["gaps"] == [[863960.0, 864000.0]]
