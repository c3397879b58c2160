"""ICGEM files: figures, time-variable terms, and files that cannot be used."""

import numpy as np
import pytest
from support import refusal, refusals

from opml.base.errors import InputError
from opml.environment import gravity_field

HEAD = """Free text in front, with a key: radius 1.0
begin_of_head
product_type gravity_field
modelname TOY
earth_gravity_constant 0.3986004415D+15
radius 6378136.46
max_degree 2
errors formal
norm fully_normalized
tide_system tide_free
key L M C S sigma_C sigma_S
end_of_head
"""
# The rows of degree 2, order 0 are EIGEN-6S's own.
ROWS = """gfc  0 0  1.0 0.0 0.0 0.0
gfct 2 0 -4.84165299820e-04 0.0 1.9551e-13 0.0 20050101
trnd 2 0 -1.26059939709e-11 0.0 3.2397e-14 0.0
acos 2 0  4.10019292536e-11 0.0 1.8982e-13 0.0 1.0
asin 2 0  5.32367408468e-11 0.0 1.9687e-13 0.0 1.0
gfc  2 1  1.0D-10 2.0d-10 0.0 0.0
gfc  2 2  2.4e-06 -1.4e-06 0.0 0.0
"""


@pytest.fixture
def read(tmp_path):
    """Reads a gravity field from text."""

    def from_text(text):
        path = tmp_path / "toy.gfc"
        path.write_text(text, encoding="latin-1")
        return gravity_field.read_icgem(path)

    return from_text


def test_egm2008_is_the_published_field():
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008"))
    assert (field.name, field.tide_system) == ("EGM2008", "tide_free")
    assert (field.max_degree, field.max_order) == (70, 70)
    assert (field.gm, field.radius) == (3.986004415e14, 6378136.3)
    # Pavlis et al. 2012: the tide-free model's first coefficients.
    assert field.c[2, 0] == -0.484165143790815e-03
    assert (field.c[2, 2], field.s[2, 2]) == (0.243938357328313e-05, -0.140027370385934e-05)
    # Kaula's rule, 1e-5 / n^2 a coefficient: a slip in the order of rows would break it.
    degrees = np.arange(3, 71)
    rms = np.sqrt((field.c[3:] ** 2 + field.s[3:] ** 2).sum(axis=1) / (2 * degrees + 1))
    assert np.all((rms * degrees**2 > 0.3e-5) & (rms * degrees**2 < 2e-5))


def test_header_and_static_rows_are_read_with_fortran_exponents(read):
    field = read(HEAD + ROWS)
    assert (field.name, field.gm, field.radius, field.max_degree) == ("TOY", 0.3986004415e15, 6378136.46, 2)
    assert (field.c[2, 1], field.s[2, 1]) == (1.0e-10, 2.0e-10)
    assert gravity_field.metadata(field) == {
        "name": "TOY",
        "gm": 0.3986004415e15,
        "radius": 6378136.46,
        "tide_system": "tide_free",
    }


@pytest.mark.parametrize(
    ("epoch", "expected"),
    [
        # UTC was 64.184 s behind TT in 2005. At the reference sine and trend vanish, the cosine is whole.
        ("2005-01-01T11:58:55.816", -4.84165299820e-04 + 4.10019292536e-11),
        # A quarter of a year of 365.25 days later (91.3125 d): the sine is whole, the cosine nought.
        ("2005-04-02T19:28:55.816", -4.84165299820e-04 - 0.25 * 1.26059939709e-11 + 5.32367408468e-11),
        # Ten years of 365.25 days later (3652.5 d; one more leap second in 2005, 2008, 2012 each).
        ("2015-01-01T23:58:52.816", -4.84165299820e-04 - 10.0 * 1.26059939709e-11 + 4.10019292536e-11),
    ],
)
def test_trend_and_seasons_count_from_the_reference_day(read, epoch, expected):
    field = read(HEAD + ROWS).freeze(epoch)
    assert field.c[2, 0] == pytest.approx(expected, abs=1e-18)
    assert field.variations == ()


@pytest.mark.parametrize(("degree", "order"), [(3, 3), (-1, 0), (2, 3)])
def test_degrees_and_orders_that_the_file_does_not_have_are_refused(read, degree, order):
    with pytest.raises(InputError, match=r"^TOY: (degree|order): expected 0 to 2, got"):
        read(HEAD + ROWS).truncate(degree, order)


@pytest.mark.parametrize(
    "key", ["product_type", "modelname", "earth_gravity_constant", "radius", "max_degree"]
)
def test_a_missing_header_key_is_named(read, key):
    head = "".join(line for line in HEAD.splitlines(True) if not line.startswith(key))
    with pytest.raises(InputError, match=rf"toy\.gfc: header: expected the key {key}"):
        read(head + ROWS)


@pytest.mark.parametrize(("old", "new", "message"), refusals("gravity_field"))
def test_what_cannot_be_used_is_named_in_one_line(read, old, new, message):
    assert f"toy.gfc: {message}" in refusal(read, (HEAD + ROWS).replace(old, new))


@pytest.mark.parametrize("kept", [0.02, 0.3, 0.5, 0.9, 0.999])
def test_a_truncated_file_is_refused(tmp_path, kept):
    whole = gravity_field.resolve("EGM2008").read_bytes()
    path = tmp_path / "cut.gfc"
    path.write_bytes(whole[: int(kept * len(whole))])
    with pytest.raises(InputError, match=r"cut\.gfc"):
        gravity_field.read_icgem(path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"absent\.gfc: no such file"):
        gravity_field.read_icgem(gravity_field.resolve(tmp_path / "absent.gfc"))
