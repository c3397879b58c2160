"""Messages in XML: the lines that key-value notation has, and so the same orbits and tracks."""

import re

import numpy as np
import pytest
from support import EPOCH, refusal

from opml.interop import known_orbits, tdm

OEM = """CCSDS_OEM_VERS = 2.0
CREATION_DATE = 2016-09-28T00:00:00
ORIGINATOR = TEST
META_START
COMMENT of one segment
OBJECT_NAME = ISS
OBJECT_ID = 1998-067-A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = UTC
START_TIME = 2016-09-28T12:09:45
STOP_TIME = 2016-09-28T12:10:45
META_STOP
2016-09-28T12:09:45 6783.0 1.0 2.0 0.1 7.5 0.2
2016-09-28T12:10:45 6768.0 451.0 14.0 -0.4 7.4 0.2
COVARIANCE_START
EPOCH = 2016-09-28T12:09:45
COV_REF_FRAME = RTN
1e-4
0 4e-4
0 0 9e-4
0 0 0 1e-10
0 0 0 0 2e-10
0 0 0 0 1e-11 3e-10
EPOCH = 2016-09-28T12:10:45
COV_REF_FRAME = RTN
2e-4
0 4e-4
0 0 9e-4
0 0 0 1e-10
0 0 0 0 2e-10
0 0 0 0 1e-11 3e-10
COVARIANCE_STOP
"""
AXES = ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")
TDM = """CCSDS_TDM_VERS = 1.0
CREATION_DATE = 2016-09-28T00:00:00
ORIGINATOR = TEST
META_START
TIME_SYSTEM = UTC
PARTICIPANT_1 = 25544
PARTICIPANT_2 = EGLIN
MODE = SEQUENTIAL
PATH = 1,2
ANGLE_TYPE = AZEL
RANGE_UNITS = km
META_STOP
DATA_START
ANGLE_1 = 2016-09-28T12:10:00 120.5
ANGLE_2 = 2016-09-28T12:10:00 30.25
RANGE = 2016-09-28T12:10:00 1200.125
DATA_STOP
"""


def leaves(lines):
    texts = [re.sub("^COMMENT ", "COMMENT = ", line).split(" = ") for line in lines]
    return "".join(f"<{key}>{value}</{key}>\n" for key, value in texts)


def oem_in_xml(text):
    """The message as 505.0-B-2 has it, of one segment."""
    head, rest = text.split("META_START\n")
    metadata, rest = rest.split("META_STOP\n")
    states, rest = rest.split("COVARIANCE_START\n")
    data = ""
    for line in states.splitlines():
        values = map(" = ".join, zip(("EPOCH", *AXES), line.split(), strict=True))
        data += f"<stateVector>{leaves(values)}</stateVector>"
    for part in rest.removesuffix("COVARIANCE_STOP\n").split("EPOCH")[1:]:
        epoch, frame, *rows = part.splitlines()
        names = [f"C{AXES[k]}_{AXES[m]}" for k in range(6) for m in range(k + 1)]
        values = map(" = ".join, zip(names, " ".join(rows).split(), strict=True))
        data += f"<covarianceMatrix>{leaves([f'EPOCH{epoch}', frame, *values])}</covarianceMatrix>"
    head = leaves(head.splitlines()[1:])
    return (
        f'<?xml version="1.0"?><ndm:oem id="CCSDS_OEM_VERS" version="2.0"><header>{head}</header><body>'
        f"<segment><metadata>{leaves(metadata.splitlines())}</metadata><data>{data}</data></segment></body></ndm:oem>"
    )


def test_an_orbit_in_xml_has_its_states_and_covariances(tmp_path):
    (tmp_path / "a.oem").write_text(OEM)
    (tmp_path / "b.xml").write_text(oem_in_xml(OEM))
    (one,), (other,) = (known_orbits.segments(tmp_path / name, epoch=EPOCH) for name in ("a.oem", "b.xml"))
    assert len(one.covariances) == 2
    for name in ("t", "states", "covariance_t", "covariances", "identity", "covariance_frame", "known"):
        np.testing.assert_array_equal(getattr(other, name), getattr(one, name))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("<X>6783.0</X>", "", "expected a time, position and velocity, got 2016-09-28T12:09:45 1.0"),
        ("<CZ_DOT_Z_DOT>3e-10</CZ_DOT_Z_DOT>", "", "expected row 6 of a covariance's lower triangle"),
        ("</ndm:oem>", "</ndm:om>", "expected messages in XML, got mismatched tag"),
        ("<REF_FRAME>EME2000</REF_FRAME>", "", "expected the key REF_FRAME before this line"),
    ],
    ids=["state", "covariance", "tags", "frame"],
)
def test_what_is_missing_in_xml_is_told_by_line(tmp_path, old, new, said):
    path = tmp_path / "b.xml"
    path.write_text(oem_in_xml(OEM).replace(old, new))
    assert said in refusal(known_orbits.segments, path, epoch=EPOCH)


def test_tracks_in_xml_have_their_measurements(tmp_path):
    head, rest = TDM.split("META_START\n")
    metadata, rest = rest.split("META_STOP\nDATA_START\n")
    observations = ""
    for line in rest.removesuffix("DATA_STOP\n").splitlines():
        key, epoch, value = line.replace(" = ", " ").split()
        observations += f"<observation><EPOCH>{epoch}</EPOCH><{key}>{value}</{key}></observation>"
    (tmp_path / "a.tdm").write_text(TDM)
    (tmp_path / "b.xml").write_text(
        f'<tdm id="CCSDS_TDM_VERS" version="1.0"><header>{leaves(head.splitlines()[1:])}</header><body>'
        f"<segment><metadata>{leaves(metadata.splitlines())}</metadata><data>{observations}</data></segment></body></tdm>"
    )
    one, other = (
        tdm.measurements([tmp_path / name], epoch=EPOCH).drop(columns=["path", "line"])
        for name in ("a.tdm", "b.xml")
    )
    assert other.equals(one)
    assert one["range"].tolist() == [1200125.0]
