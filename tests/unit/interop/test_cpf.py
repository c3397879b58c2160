"""CPF: versions 1 and 2, velocities, satellites, and what is refused."""

import numpy as np
import pytest
from orbit_files import cpf as written
from support import EPOCH, edited, refusal, refusals, shared

from opml.base.errors import InputError
from opml.interop.orbit_arcs import contents
from opml.interop.orbit_formats import cpf

T = np.array([15.0, 195.0, 43020.0, 43200.0])  # across midnight
STATES = np.random.default_rng(1).uniform(-7e6, 7e6, (4, 6)) * np.repeat([1.0, 1e-3], 3)


def read(path, satellite=None):
    (arc,) = cpf.read(path, contents(path), epoch=EPOCH, satellite=satellite)
    return arc


@pytest.mark.parametrize("name", ["orbit.cpf", "orbit.cpf.gz"])
@pytest.mark.parametrize("version", [1, 2])
def test_what_was_written_is_read(tmp_path, name, version):
    arc = read(written(tmp_path / name, T, STATES, version=version))
    np.testing.assert_allclose(arc.t, T, rtol=0, atol=1e-6)
    np.testing.assert_allclose(arc.positions, STATES[:, :3], rtol=0, atol=1e-4)
    assert np.isnan(arc.velocities).all()
    assert (arc.satellite, arc.frame, arc.scale) == ("larets", "ITRF", "UTC")
    assert arc.lines.tolist() == [4, 5, 6, 7]


def test_velocities_belong_to_the_positions_before_them(tmp_path):
    path = written(tmp_path / "orbit.cpf", T, STATES, velocities=True)
    lines = path.read_text().splitlines()
    assert lines[6].startswith("20 ")
    path.write_text("\n".join([*lines[:6], "00 a remark", *lines[7:]]))
    arc = read(path)
    np.testing.assert_allclose(arc.velocities[[0, 2, 3]], STATES[[0, 2, 3], 3:], rtol=0, atol=1e-7)
    assert np.isnan(arc.velocities[1]).all()


@pytest.mark.parametrize("satellite", ["larets", "LARETS", "304206", "4206", "27944"])
def test_the_satellite_goes_by_name_and_numbers(tmp_path, satellite):
    assert read(written(tmp_path / "orbit.cpf", T, STATES), satellite).satellite == "larets"


def test_another_satellite_is_refused(tmp_path):
    with pytest.raises(InputError, match="expected satellite stella, got larets"):
        read(written(tmp_path / "orbit.cpf", T, STATES), "stella")


@pytest.mark.parametrize(("old", "new", "message"), refusals("cpf"))
def test_what_is_malformed_is_named_by_file_and_line(tmp_path, old, new, message):
    path = edited(written(tmp_path / "orbit.cpf", T, STATES), old, new)
    assert refusal(read, path).startswith(f"{path}: {message}")


@pytest.mark.parametrize(
    ("name", "satellite", "first"),
    [
        ("jason3_cpf_180613_16401.cne", "jason3", [6566174.663, 2703003.220, -3022783.901]),
        ("lageos1_cpf_180613_16401.hts", "lageos1", [2966379.904, 4195129.466, -11136763.061]),
        ("larets_2022-07-04_60d.cpf.gz", "larets", [1233258.567, 2098035.749, 6624838.001]),
    ],
)
def test_files_as_issued_are_read(name, satellite, first):
    arc = read(shared(f"real/cpf/{name}"))
    assert arc.satellite == satellite
    assert arc.positions[0].tolist() == first
