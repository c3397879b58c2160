"""The list of formats: each file has one, whatever stands before its first key, and refusals name it."""

import os
import time
from threading import Thread

import pytest

from opml.base.errors import InputError
from opml.interop import formats
from opml.interop.orbit_arcs import contents

BEGINNINGS = {
    "TLE": b"ISS (ZARYA)\n1 25544U 98067A   26263.12500000",
    "TLE of a name like JSON": b"{NAME: X}\r\n1 25544U 98067A   26263.12500000",
    "TLE behind words": b"# of today\nNAME\nOTHER\n1 A0001U 98067A",
    "OMM of KVN": b"COMMENT a = [\nCCSDS_OMM_VERS = 2.0\n",
    "OMM of JSON": b' [{"OBJECT_NAME": "1 25544U", "MEAN_MOTION": 15}]',
    "JSON without MEAN_MOTION": b'[{"CDM_ID": "1", "PC": "0.1"}]',
    "a list of objects (SATCAT) in CSV": b"OBJECT_NAME,OBJECT_ID,NORAD_CAT_ID,OPS_STATUS_CODE\n",
    "a list of objects (SATCAT) in JSON": b'[{"INTLDES":"1957-001A","SATNAME":"SL-1 R/B"}]',
    "a list of objects (SATCAT) in text": b"1957-001A    00001   D SL-1 R/B          CIS    1957-10-04\n",
    "space weather": b"DATE,BSRN,ND,KP1,KP2\n",
    "space weather in text": b"DATATYPE CssiSpaceWeather\nVERSION 1.2\n",
    "Earth orientation": b"DATE,MJD,X,Y,UT1-UTC\n",
    "OMM of XML": b'<?xml version="1.0"?>\n<ndm>\n<omm id="x">',
    "OMM of CSV": b"CCSDS_OMM_VERS,EPOCH,MEAN_MOTION,BSTAR\n",
    "OEM": b"\nCOMMENT made by hand\nCOMMENT 1\nCCSDS_OEM_VERS = 2.0\n",
    "SP3": b"#dV2019  9  2 23 59 42",
    "CPF": b"H1 CPF  2  TST",
    "TDM": b"CCSDS_TDM_VERS=1.0",
    "CDM": b"CCSDS_CDM_VERS = 1.0",
    "Parquet": b"PAR1....",
    "laser ranges (CRD), which a study reads: opml docs tracks": b"h1 CRD  1 2016",
    "a web page": b"<!doctype HTML>\n<html>",
    "a web page in XML": b'<?xml version="1.0"?>\n<!DOCTYPE html PUBLIC "x">\n<html>',
    "an archive, not gzip": b"PK\3\4" + bytes(9),
    "CSV of points": b"utc,x_itrf_m,y_itrf_m,z_itrf_m\n",
    "CSV of points by blanks": b"Time (UTCG)   x (km)   y (km)   z (km)\n",
}


@pytest.mark.parametrize("name", BEGINNINGS)
def test_a_file_has_the_format_that_it_begins_as(name):
    kinds = {one.kind for one in formats.FORMATS}
    assert name.startswith(formats.of("file", BEGINNINGS[name], *kinds).name)


@pytest.mark.parametrize("filling", [b"\n", b" ", b"COMMENT a\n", b"<", b"[", b"a "], ids=str)
def test_the_format_of_much_of_the_same_is_known_in_time(filling):
    begun = time.process_time()
    for one in formats.FORMATS:
        one.matches(20_000 * filling)
    assert time.process_time() - begun < 1.0


def test_a_pipe_is_read_once_and_serves_twice(tmp_path):
    pipe = tmp_path / "sets.tle"
    os.mkfifo(pipe)
    Thread(target=pipe.write_bytes, args=[BEGINNINGS["TLE"]], daemon=True).start()
    assert contents(pipe) == contents(pipe) == BEGINNINGS["TLE"]


@pytest.mark.parametrize(
    ("content", "got"),
    [
        (b"#dV2019  9  2 23 59 42", "SP3"),
        (b"GP data has not updated since your last download\n", "CelesTrak: not updated"),
        (b"CCSDS_OPM_VERS = 2.0", "'CCSDS_OPM_VERS = 2.0'"),
        (b" \n", "an empty file"),
        (b"\xff\xfe\0", "bytes that are no text in UTF-8"),
        ("é".encode() * 400, "'éé"),
    ],
    ids=["another", "no sets", "another message", "nothing", "bytes", "letters"],
)
def test_a_refusal_names_what_was_given_and_all_that_is_read(content, got):
    with pytest.raises(InputError) as told:
        formats.of("file", content, formats.ELEMENTS, formats.TRACKS)
    assert str(told.value).startswith(f"file: expected element sets (TLE, OMM) or tracks (TDM), got {got}")
