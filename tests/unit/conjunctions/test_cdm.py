"""Conjunction data messages: published cases, a way out and back, and damaged files told in one line."""

import io
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import refusals, shared

from opml import cli
from opml.base.errors import InputError
from opml.conjunctions import as_text, cdm
from opml.conjunctions.conjunction import Conjunction, Participant
from opml.conjunctions.probability import chance
from opml.dynamics.frames import gcrf_to_itrf
from opml.environment import earth_orientation
from opml.interop import ccsds
from opml.interop.object_ids import ObjectId
from opml.orbits.density_error import DensityError

EPOCH = "2000-01-01T00:00:00"
PUBLISHED = {1: 0.146749549, 3: 0.100351176, 4: 0.049323406, 6: 0.004335455, 7: 0.000158147, 9: 0.290146291}
"""Probabilities in two dimensions by NASA's CARA, as Orekit's methods are tested on them."""


def participant(name, sign=1.0, sigma=(30.0, 400.0, 20.0, 0.4, 0.03, 0.02)):
    state = np.array([7e6 + 40.0 * (sign < 0), 30.0 * (sign < 0), 0.0, 1.0, 5300.0 * sign, 5300.0])
    rng = np.random.default_rng(2)
    turn = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    mixed = np.diag(sigma) @ (np.eye(6) + 0.1 * turn)
    return Participant(ObjectId(name), state, mixed @ mixed.T)


def shifted(name, metres, sign=1.0):
    """A participant that a tenth more of density shifts along its track."""
    density = DensityError(0.1, np.array([0.0, 10.0 * metres, 0.0, -0.01 * metres, 0.0, 0.0]))
    return replace(participant(name, sign), density=density)


CONJUNCTION = Conjunction(12345.678901, participant("ours"), participant("other", -1.0), 20.0)


@pytest.fixture
def message(tmp_path):
    """The conjunction as a message."""
    cdm.write(tmp_path / "one.cdm", CONJUNCTION, epoch=EPOCH)
    return tmp_path / "one.cdm"


@pytest.mark.parametrize("number", PUBLISHED)
def test_published_cases_have_their_probability(number):
    conjunction = cdm.read(shared(f"real/cdm/AlfanoTestCase{number:02d}.cdm"), epoch=EPOCH)[0]
    assert conjunction.t == 0.0
    assert chance(conjunction.encounter).probability == pytest.approx(PUBLISHED[number], rel=1e-4)


def test_what_is_written_comes_back(message):
    found = cdm.read(message, epoch=EPOCH)[0]
    assert found.t == pytest.approx(CONJUNCTION.t, abs=1e-6)
    assert found.radius == CONJUNCTION.radius
    for one, other in ((found.first, CONJUNCTION.first), (found.second, CONJUNCTION.second)):
        assert one.identity == other.identity
        np.testing.assert_array_equal(one.state, other.state)
        np.testing.assert_array_equal(one.covariance, other.covariance)
    text = message.read_text()
    assert f"COLLISION_PROBABILITY = {CONJUNCTION.chance.probability!r}" in text
    assert f"RELATIVE_POSITION_R = {float(CONJUNCTION.relative[0])!r} [m]" in text


def test_a_relative_position_that_is_not_that_of_the_states_is_told(message, caplog):
    """One in another frame is as far, so that the miss distance is none the wiser."""
    cdm.read(message, epoch=EPOCH)
    assert caplog.messages == []
    x, y = (repr(float(value)) for value in CONJUNCTION.relative[:2])
    text = message.read_text().replace(f"POSITION_R = {x}", f"POSITION_R = {y}")
    message.write_text(text.replace(f"POSITION_T = {y}", f"POSITION_T = {x}"))
    cdm.read(message, epoch=EPOCH)
    (told,) = caplog.messages
    assert re.search(
        r"one\.cdm: RELATIVE_POSITION is .* m, that of the states .*: is REF_FRAME right\?", told
    )
    message.write_text(text.replace(f"POSITION_R = {y} [m]", "POSITION_R = N/A"))
    cdm.read(message, epoch=EPOCH)
    assert len(caplog.messages) == 1


def test_states_on_the_turning_earth_are_those_of_gcrf(tmp_path):
    """Velocities on it are differences of positions on it."""
    path, t = tmp_path / "one.cdm", CONJUNCTION.t + np.array([-0.5, 0.0, 0.5])
    cdm.write(path, CONJUNCTION, epoch=EPOCH)
    turns = gcrf_to_itrf(earth_orientation.tabulate(EPOCH, 3600.0 * np.arange(12.0)), t)
    text = path.read_text().replace("REF_FRAME = GCRF", "REF_FRAME = ITRF")
    for one in (CONJUNCTION.first, CONJUNCTION.second):
        positions = one.state[:3] + np.outer(t - CONJUNCTION.t, one.state[3:])
        before, now, after = np.einsum("nij,nj->ni", turns, positions)
        for name, old, new in zip(cdm._STATE, one.state, [*now, *(after - before)], strict=True):
            text = text.replace(
                f"\n{name} = {ccsds.number_text(old, -3)} ", f"\n{name} = {1e-3 * float(new)!r} ", 1
            )
    path.write_text(text)
    found = cdm.read(path, epoch=EPOCH)[0]
    np.testing.assert_allclose(found.first.state, CONJUNCTION.first.state, rtol=0.0, atol=1e-3)
    np.testing.assert_allclose(found.second.state, CONJUNCTION.second.state, rtol=0.0, atol=1e-3)
    assert found.chance.probability == pytest.approx(CONJUNCTION.chance.probability, rel=1e-3)


def test_the_common_error_of_density_comes_back_and_makes_another_probability(tmp_path):
    together = replace(CONJUNCTION, first=shifted("ours", 300.0), second=shifted("other", -350.0, -1.0))
    assert together.chance.probability == CONJUNCTION.chance.probability
    path = tmp_path / "one.cdm"
    cdm.write(path, together, epoch=EPOCH)
    found = cdm.read(path, epoch=EPOCH)[0]
    assert found.first.density.uncertainty == 0.1
    np.testing.assert_array_equal(found.second.density.sensitivity, together.second.density.sensitivity)
    (row,) = as_text.table([found], epoch=EPOCH).to_dict("records")
    assert row["correlated"] == found.correlated.chance.probability
    assert abs(row["correlated"] / row["probability"] - 1.0) > 0.1
    assert f"DENSITY ERROR = {together.correlated.chance.probability!r}" in path.read_text()
    alone = replace(together, second=CONJUNCTION.second)
    assert np.isnan(as_text.table([alone], epoch=EPOCH)["correlated"].iat[0])


def test_an_error_of_density_beyond_its_covariance_is_remarked_on_and_not_used(tmp_path):
    path = tmp_path / "one.cdm"
    cdm.write(path, replace(CONJUNCTION, first=shifted("ours", 300.0)), epoch=EPOCH)
    path.write_text(path.read_text().replace("Pos = 0.0 3", "Pos = 0.0 93", 1))
    (row,) = as_text.table([cdm.read(path, epoch=EPOCH)[0]], epoch=EPOCH).to_dict("records")
    assert row["probability"] == pytest.approx(CONJUNCTION.chance.probability, rel=1e-3)
    assert np.isnan(row["correlated"])
    assert "density error of ours too large" in row["remark"]


@pytest.mark.parametrize(("old", "new", "expected"), refusals("density_in_cdm"))
def test_a_damaged_error_of_density_is_told(tmp_path, old, new, expected):
    path = tmp_path / "one.cdm"
    together = replace(CONJUNCTION, first=shifted("ours", 300.0), second=shifted("other", -350.0, -1.0))
    cdm.write(path, together, epoch=EPOCH)
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=rf"one\.cdm: line \d+: expected .*{expected}"):
        cdm.read(path, epoch=EPOCH)[0]


def test_messages_are_named_by_objects_and_time_and_need_both_covariances(tmp_path):
    lonely = Conjunction(
        0.0, CONJUNCTION.first, Participant(ObjectId("bare"), CONJUNCTION.second.state), 20.0
    )
    cdm.write_all(tmp_path / "messages", [CONJUNCTION, lonely], epoch=EPOCH)
    assert [path.name for path in (tmp_path / "messages").iterdir()] == [
        "ours_other_20000101T032545678901.cdm"
    ]
    with pytest.raises(InputError, match=r"^bare: expected a covariance"):
        cdm.write(tmp_path / "no.cdm", lonely, epoch=EPOCH)
    assert not (tmp_path / "no.cdm").exists()


@pytest.mark.parametrize(("old", "new", "expected"), refusals("cdm"))
def test_damaged_messages_are_told_in_one_line(message, old, new, expected):
    text = message.read_text()
    assert old in text
    message.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=expected) as raised:
        cdm.read(message, epoch=EPOCH)[0]
    assert str(raised.value).startswith(str(message))
    assert "\n" not in str(raised.value)


def test_a_message_that_ends_at_once_is_told(tmp_path):
    (tmp_path / "one.cdm").write_text("CCSDS_CDM_VERS = 1.0\n")
    with pytest.raises(InputError, match=r"one\.cdm: line 1: expected KEY = value, got nothing"):
        cdm.read(tmp_path / "one.cdm", epoch=EPOCH)[0]


def test_a_name_stays_within_the_folder(tmp_path):
    pair = [
        replace(one, identity=ObjectId(f"../{one.identity} 1/b"))
        for one in (CONJUNCTION.first, CONJUNCTION.second)
    ]
    cdm.write_all(tmp_path / "m", [Conjunction(0.0, *pair, 20.0)], epoch=EPOCH)
    (written,) = (tmp_path / "m").iterdir()
    assert written.name == "-ours-1-b_..-other-1-b_20000101T000000000000.cdm"
    assert [path.name for path in tmp_path.iterdir()] == ["m"]


@pytest.mark.parametrize("text", ["20.0", "20.0 [m]", "0.02 [km]", "0.02[km]"])
def test_the_radius_has_the_unit_that_it_tells(message, text):
    message.write_text(message.read_text().replace("HBR = 20.0", f"HBR = {text}"))
    assert cdm.read(message, epoch=EPOCH)[0].radius == pytest.approx(20.0)


def test_the_caller_knows_the_radius_better(message, capsys):
    assert cdm.read(message, epoch=EPOCH, radius=5.0)[0].radius == 5.0
    message.write_text(message.read_text().replace("COMMENT HBR = 20.0\n", ""))
    assert cli.main(["screen", str(message), "--radius", "20", "--csv"]) == 0
    assert f"{CONJUNCTION.chance.probability:.6}"[:6] in capsys.readouterr().out
    assert cli.main(["screen", str(message), "--radius", "-1"]) == 1
    assert capsys.readouterr().err == "opml: radius: expected a length above 0, got -1 m\n"


def test_a_message_has_the_date_of_what_it_is_made_from(tmp_path, monkeypatch):
    cdm.write(tmp_path / "one.cdm", replace(CONJUNCTION, known=3600.0), epoch=EPOCH)
    assert "CREATION_DATE = 2000-01-01T01:00:00.000000\n" in (tmp_path / "one.cdm").read_text()
    assert cdm.read(tmp_path / "one.cdm", epoch=EPOCH)[0].known == 3600.0
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    cdm.write(tmp_path / "one.cdm", CONJUNCTION, epoch=EPOCH)
    assert "CREATION_DATE = 1970-01-02T00:00:00.000000\n" in (tmp_path / "one.cdm").read_text()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "now")
    with pytest.raises(InputError, match=r"^SOURCE_DATE_EPOCH: expected seconds since 1970, got now"):
        cdm.write(tmp_path / "one.cdm", CONJUNCTION, epoch=EPOCH)


CARA_TABLE = "real/cara/probabilities.tsv"
FAR_FROM_ITS_MONTE_CARLO = "000043613_conj_000052010_20230626_045217_20230620_061741"
"""By 12 %, of 599 hits; NASA's own 3D-Nc is off by 10 %, our importance sampling equals ours to 1 %."""


def test_real_conjunctions_have_nasas_probability_by_monte_carlo():
    """Within its interval of 95 %, or to 5 %: two by 3D-Nc, the others by 2D-Nc."""
    methods = []
    for row in pd.read_csv(shared(CARA_TABLE), sep="\t").itertuples():
        conjunction = cdm.read(shared(f"real/cara/{row.Conjunction_ID}.cdm.gz"), epoch=EPOCH)[0]
        ratio = conjunction.chance.probability / row.PcSDMC
        methods.append(conjunction.method)
        within = 0.13 if row.Conjunction_ID == FAR_FROM_ITS_MONTE_CARLO else 0.05
        is_near = row.PcSDMCLo <= conjunction.chance.probability <= row.PcSDMCHi
        assert is_near or abs(ratio - 1.0) < within, row.Conjunction_ID
    assert methods.count("2D-Nc") == 25
    assert methods.count("3D-Nc") == 2


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_covariance_that_is_none_is_told(sign, tmp_path):
    """Position and velocity of a real object agree; with another sign no errors have such covariances."""
    name = "000020580_conj_000002017_20230613_001923_20230608_063715"
    real = cdm.read(shared(f"real/cara/{name}.cdm.gz"), epoch=EPOCH)[0]
    covariance = real.first.covariance.copy()
    covariance[[0, 1], [1, 0]] *= sign
    cdm.write(
        tmp_path / "one.cdm", replace(real, first=replace(real.first, covariance=covariance)), epoch=EPOCH
    )
    (row,) = as_text.table([cdm.read(tmp_path / "one.cdm", epoch=EPOCH)[0]], epoch=EPOCH).to_dict("records")
    assert ("covariance not positive definite" in row["remark"]) == (sign < 0.0)
    assert 0.0 <= row["correlated"] <= row["probability"] < 1e-3


def test_of_a_hyperbola_the_states_are_taken(tmp_path):
    leaving = replace(CONJUNCTION.second, state=CONJUNCTION.second.state * np.array([1, 1, 1, 2, 2, 2]))
    gone = replace(CONJUNCTION, second=leaving)
    assert gone.method == "2D-Pc"
    assert gone.chance == chance(gone.encounter)
    cdm.write(tmp_path / "gone.cdm", gone, epoch=EPOCH)
    assert "COLLISION_PROBABILITY_METHOD = FOSTER-1992\n" in (tmp_path / "gone.cdm").read_text()


def test_messages_in_a_row_and_in_a_folder_are_all_read(message, tmp_path, capsys):
    text = message.read_text()
    both = tmp_path / "cdms" / "both.txt"
    both.parent.mkdir()
    third = text.replace("HBR = 20.0", "HBR = 5.0 [m]").replace("= other", "= third")
    both.write_text(text + re.sub("COLLISION_PROBABILITY = .*", "COLLISION_PROBABILITY = N/A", third))
    (both.parent / "one.cdm").write_text(text)
    assert [one.radius for one in cdm.read(both, epoch=EPOCH)] == [20.0, 5.0]
    assert cli.main(["screen", str(both.parent), "--csv"]) == 0
    rows = pd.read_csv(io.StringIO(capsys.readouterr().out))
    assert list(rows["second"]) == ["other", "other", "third"]  # the likeliest first
    assert list(rows["radius_m"]) == [20.0, 20.0, 5.0]
    np.testing.assert_array_equal(rows["stated"], [*rows["probability"][:2], np.nan])


def without(text, *keys):
    return "".join(line for line in text.splitlines(True) if not line.startswith(keys))


@pytest.mark.parametrize("damage", ["no rows of velocities", "correlations of velocities beyond 1"])
def test_positions_are_all_that_a_probability_in_two_dimensions_needs(message, damage):
    """As of the example of CCSDS 508.0-B-1, whose velocities have correlations beyond 1."""
    text = message.read_text()
    begin = text.index("CRDOT_R = ")
    line = text[begin : text.index("\n", begin)]
    rows = ("CRDOT", "CTDOT", "CNDOT")
    changed = without(text, *rows) if damage.startswith("no") else text.replace(line, "CRDOT_R = 1e9", 1)
    whole = cdm.read(message, epoch=EPOCH)[0]
    message.write_text(changed)
    (found,) = cdm.read(message, epoch=EPOCH)
    assert found.method == "2D-Pc"
    assert found.chance.probability == pytest.approx(chance(whole.encounter).probability, rel=1e-12)
    (row,) = as_text.table([found], epoch=EPOCH).to_dict("records")
    assert f"covariance of ours of its position alone: {damage}" in row["remark"]


def test_a_message_without_covariances_has_its_miss(message):
    message.write_text(without(message.read_text(), "CR", "CT_", "CTDOT", "CN_", "CNDOT"))
    (found,) = cdm.read(message, epoch=EPOCH)
    assert found.chance is None
    assert np.linalg.norm(found.relative[:3]) == pytest.approx(50.0, rel=1e-3)


def test_a_message_in_xml_is_the_same(message):
    """As 505.0-B-2 has it: a segment of each object, units as attributes."""
    expected = cdm.read(message, epoch=EPOCH)[0]
    elements = []
    for line in message.read_text().splitlines()[1:]:
        key, _, value = line.removeprefix("COMMENT ").partition(" = ")
        if line.startswith("COMMENT"):
            elements.append(f"<COMMENT>{key} = {value}</COMMENT>")
            continue
        value, _, unit = value.partition(" [")
        if key == "OBJECT":
            elements.append("</segment><segment><metadata>")
        elements.append(f'<{key} units="{unit[:-1]}">{value}</{key}>' if unit else f"<{key}>{value}</{key}>")
        if key == "REF_FRAME":
            elements.append("</metadata>")
    body = "\n".join(elements).replace("</segment>", "", 1)
    message.write_text(
        f'<?xml version="1.0"?>\n<cdm id="CCSDS_CDM_VERS" version="1.0">{body}</segment></cdm>\n'
    )
    (found,) = cdm.read(message, epoch=EPOCH)
    np.testing.assert_array_equal(found.first.covariance, expected.first.covariance)
    np.testing.assert_array_equal(found.second.state, expected.second.state)
    assert (found.radius, found.t) == (20.0, expected.t)
