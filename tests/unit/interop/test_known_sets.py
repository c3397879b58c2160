"""Sets of mean elements: one in all notations, sets twice or out of order, files that are damaged."""

import gzip
import json
import re
from pathlib import Path

import numpy as np
import pytest
import sgp4
from support import refusal, refusals, shared

from opml.base.errors import InputError
from opml.dynamics.frames import gcrf_to_itrf
from opml.environment import earth_orientation, nodes
from opml.interop.element_sets import element_set, known_sets, mean_elements
from opml.interop.element_sets.element_set import seconds_since
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.interop.orbit_from_files import OrbitFiles, read_arcs

EPOCH = "2024-01-01T00:00:00"
DAY = 86400.0


def tle(
    *, number="12345", day="001.50000000", motion="15.50000000", node="210.5000", bstar=" 30000-3", kind="0"
):
    """The two lines of a set of 2024 with their checksums."""
    lines = (
        f"1 {number}U 20001A   24{day}  .00012000  00000-0 {bstar} {kind}  999",
        f"2 {number}  51.6400 {node} 0005000  40.2500 319.8000 {motion}12345",
    )
    return [f"{line}{sum(int(c) if c.isdigit() else c == '-' for c in line) % 10}" for line in lines]


def omm(*, day="01", created="", **changed):
    """The keys of the same set as CelesTrak gives them, and the date of creation."""
    values = {
        "OBJECT_NAME": "A, B",
        "OBJECT_ID": "2020-001A",
        "EPOCH": f"2024-01-{day}T12:00:00.000000",
        "MEAN_MOTION": "15.5",
        "ECCENTRICITY": ".0005",
        "INCLINATION": "51.64",
        "RA_OF_ASC_NODE": "210.5",
        "ARG_OF_PERICENTER": "40.25",
        "MEAN_ANOMALY": "319.8",
        "EPHEMERIS_TYPE": "0",
        "CLASSIFICATION_TYPE": "U",
        "NORAD_CAT_ID": "12345",
        "ELEMENT_SET_NO": "999",
        "REV_AT_EPOCH": "1234",
        "BSTAR": ".3E-3",
        "MEAN_MOTION_DOT": ".12E-3",
        "MEAN_MOTION_DDOT": "0",
    }
    return values | ({"CREATION_DATE": created} if created else {}) | changed


DAYS = ("01", "02", "03")
LINES = [tle(day=f"0{day}.50000000") for day in DAYS]
SETS = [omm(day=day) for day in DAYS]


def text(*sets):
    return "".join(f"{line}\n" for lines in sets for line in lines)


def kvn(*sets):
    heads = ({"CCSDS_OMM_VERS": "2.0", "CREATION_DATE": ""} | one for one in sets)
    return "\n".join("".join(f"{key} = {value}\n" for key, value in one.items()) for one in heads)


def csv(*sets, quote=False):
    """A list with commas, in quotes where a name has one."""
    rows = (sets[0], *(one.values() for one in sets))
    cells = ([f'"{cell}"' if quote or "," in cell else cell for cell in row] for row in rows)
    return "".join(",".join(row) + "\r\n" for row in cells)


def xml(*sets):
    message = (
        '<omm id="CCSDS_OMM_VERS" version="2.0"><header><CREATION_DATE>{}</CREATION_DATE></header>'
        "<body><segment>{}</segment></body></omm>"
    )
    messages = []
    for one in sets:
        elements = {key: value for key, value in one.items() if key != "CREATION_DATE"}
        tags = "".join(f"<{key}>{value}</{key}>\n" for key, value in elements.items())
        messages.append(message.format(one.get("CREATION_DATE", ""), tags))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<ndm>{"".join(messages)}</ndm>\n'


NOTATIONS = {
    "tle": text(*LINES),
    "3le": text(*(["0 A, B", *lines] for lines in LINES)),
    "named": text(*(["A, B                    ", *lines] for lines in LINES)),
    "crlf": text(*LINES).replace("\n", "\r\n"),
    "old ends of lines": text(*LINES).replace("\n", "\r"),
    "blanks at the end": text(*LINES).replace("\n", "   \n"),
    "gzip in parts": b"".join(gzip.compress(text(one).encode(), mtime=0) for one in LINES),
    "bom": "\ufeff" + text(*LINES),
    "kvn": kvn(*SETS),
    "tight kvn": kvn(*SETS).replace(" = ", "=").replace("=51.64", "=51.64 [deg]"),
    "units": kvn(*(one | {"INCLINATION": f"{one['INCLINATION']} [DEG]"} for one in SETS)),
    "xml": xml(*SETS),
    "units in xml": xml(*SETS).replace("<MEAN_MOTION>", '<MEAN_MOTION units="rev/day">'),
    "json": json.dumps(SETS),
    "indented": json.dumps(SETS, indent=1),
    "wrapped": json.dumps({"request_metadata": {"Total": 4, "data": []}, "data": SETS}),
    "numbers": json.dumps(
        [one | {"BSTAR": 0.0003, "NORAD_CAT_ID": 12345, "DECAY_DATE": None} for one in SETS]
    ),
    "nulls": json.dumps([one | dict.fromkeys(["OBJECT_ID", "MEAN_MOTION_DOT"]) for one in SETS]),
    "csv": csv(*SETS),
    "centre": csv(*(one | {"CENTER_NAME": "Earth"} for one in SETS)),
    "quoted": csv(*({"CCSDS_OMM_VERS": "2.0", "COMMENT": "X"} | one for one in SETS), quote=True),
    "joined": csv(*SETS[:2]) + csv(*SETS[2:]),
    "older": json.dumps([omm(EPOCH=f"2024-01-{day} 11:59:59", EPOCH_MICROSECONDS="999999") for day in DAYS]),
    "unneeded": csv(*(omm(day=day, CLASSIFICATION_TYPE="UNKNOWN", OBJECT_ID="") for day in DAYS)),
    "day of year": csv(
        *(one | {"EPOCH": f"2024-0{day}T12:00:00Z"} for one, day in zip(SETS, DAYS, strict=True))
    ),
}


@pytest.fixture
def written(tmp_path):
    def write(content, name="sets"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.fixture
def read(written):
    """Read sets of one object or several, in the order of numbers and epochs."""

    def read(*contents):
        paths = [written(content, f"sets{k}") for k, content in enumerate(contents)]
        return [one for sets in known_sets.by_object(paths).values() for one in sets]

    return read


def times(sets):
    """Epochs of sets [s since EPOCH]."""
    return seconds_since(EPOCH, [one.satellite for one in sets])


def elements(one):
    """Mean motion [rad/s], eccentricity, angles [rad] and B* of a set."""
    made = one.satellite
    return [made.no_kozai / 60.0, made.ecco, made.inclo, made.nodeo, made.argpo, made.mo, made.bstar]


def states(one, t):
    return mean_elements.states(one.satellite, epoch=EPOCH, t=t)


@pytest.mark.parametrize("content", NOTATIONS.values(), ids=NOTATIONS)
def test_every_notation_gives_the_same_sets(read, content):
    sets = read(content)
    assert [one.number for one in sets] == [12345] * 3
    np.testing.assert_allclose(times(sets), (np.arange(3) + 0.5) * DAY, rtol=0, atol=2e-6)
    turn = 2 * np.pi / DAY
    expected = [15.5 * turn, 5e-4, *np.deg2rad([51.64, 210.5, 40.25, 319.8]), 3e-4]
    np.testing.assert_allclose([elements(one) for one in sets], [expected] * 3, rtol=1e-14)
    assert {one.created for one in sets} == {""}


def test_each_set_tells_where_it_stands(read):
    starts = {"tle": [1, 3, 5], "3le": [2, 5, 8], "csv": [2, 3, 4], "kvn": [1, 21, 41], "xml": [2, 19, 36]}
    for name, lines in starts.items():
        assert [one.line for one in read(NOTATIONS[name])] == lines
    assert [one.line for one in read(json.dumps(SETS, indent=0))] == [2, 21, 40]


def test_gzipped_files_of_different_notations_are_one_history(read):
    sets = read(gzip.compress(text(LINES[2]).encode(), mtime=0), json.dumps(SETS[:1]), kvn(SETS[1]))
    np.testing.assert_allclose(times(sets), (np.arange(3) + 0.5) * DAY, rtol=0, atol=1e-6)
    assert [Path(one.path).name for one in sets] == ["sets1", "sets2", "sets0"]


def test_of_sets_of_one_epoch_the_one_that_was_made_last_counts(read):
    late, early = "2024-01-02T06:00:00", "2024-01-01T18:00:00"
    sets = [omm(created=late, RA_OF_ASC_NODE="210.6"), omm(created=early), omm()]
    (known,) = known_sets.since(EPOCH, read(json.dumps(sets)))
    assert np.rad2deg(known.satellite.nodeo) == pytest.approx(210.6)
    assert known.made == DAY + 6 * 3600.0


@pytest.mark.parametrize(
    ("content", "number"),
    [
        (text(tle(number="A0000")), 100_000),
        (text(tle(number="J2931")), 182_931),
        (text(tle(number="P4018")), 234_018),
        (text(tle(number="Z9999")), 339_999),
        (text(tle(number="    5")), 5),
        (json.dumps(omm(NORAD_CAT_ID="100000")), 100_000),
        (json.dumps(omm(NORAD_CAT_ID=340000)), 340_000),
        (csv(omm(NORAD_CAT_ID="799500001")), 799_500_001),
        (kvn(omm(NORAD_CAT_ID="999999999")), 999_999_999),
    ],
    ids=["A0000", "J2931", "P4018", "Z9999", "blanks", "text of JSON", "number of JSON", "CSV", "KVN"],
)
def test_catalogue_numbers_have_up_to_nine_digits(read, content, number):
    assert [one.number for one in read(content)] == [number]


@pytest.mark.parametrize("write", [kvn, xml, csv])
def test_the_date_of_creation_is_read_from_every_notation(read, write):
    dated = [omm(day=day, created=f"2024-01-{day}T18:00:00.5") for day in DAYS]
    known = known_sets.since(EPOCH, read(write(*dated)))
    np.testing.assert_allclose([one.made - one.t for one in known], 6 * 3600.0 + 0.5, rtol=0, atol=1e-5)


def test_objects_are_told_apart(written):
    path = written(json.dumps([omm(NORAD_CAT_ID="270000001", MEAN_MOTION="1.0027"), *SETS]))
    assert {number: len(sets) for number, sets in known_sets.by_object([path]).items()} == {
        12345: 3,
        270_000_001: 1,
    }
    assert times(known_sets.of_object([path], "270000001")).tolist() == [0.5 * DAY]
    for wanted, expected in (("7", "one object 7"), (None, "--object for one of several objects")):
        assert f"expected {expected}, got 12345 A, B, 270000001" in refusal(
            known_sets.of_object, [path], wanted
        )


def test_where_the_object_decayed_there_is_no_state(read):
    (one,) = read(text(tle(motion="16.20000000", bstar=" 30000-2")))
    early, late = states(one, np.array([0.6, 300.0]) * DAY)
    assert np.isfinite(early).all()
    assert np.isnan(late).all()


def test_a_leap_second_is_a_second_of_flight(written):
    # 2016 ended with one: from noon to noon there were 86 401 s.
    satellite = mean_elements.read(written(csv(omm(EPOCH="2016-12-31T12:00:00"))))
    _, position, _ = satellite.sgp4_tsince(86_401.0 / 60.0)
    found = mean_elements.state(satellite, epoch="2017-01-01T12:00:00")
    assert np.linalg.norm(found[:3]) == pytest.approx(1e3 * np.linalg.norm(position), abs=0.01)
    turn = teme_to_gcrf("2017-01-01T12:00:00", np.zeros(1))[0]
    np.testing.assert_allclose(found[:3], 1e3 * turn @ position, rtol=0, atol=0.02)


FIRST, SECOND = tle()
OTHER = tle(number="54321")
ROW = csv(omm())
PAGE = "<!DOCTYPE html>\n<html><head><title>403</title></head>\n<body><br></body></html>\n"
DAMAGED = {
    "error page behind sets": (text(*LINES) + PAGE, ": line 8: expected line 1 of a TLE, got '<html>"),
    "archive": (b"PK\3\4" + bytes(40), ": expected element sets (TLE, OMM), got an archive, not gzip"),
    "packed twice": (
        gzip.compress(gzip.compress(text(*LINES).encode(), mtime=0), mtime=0),
        ": expected element sets (TLE, OMM), got bytes that are no text",
    ),
    "more behind gzip": (
        gzip.compress(text(*LINES).encode(), mtime=0) + b"more",
        ": expected a file that is whole, got Not a gzipped file (b'mo')",
    ),
    "json comma": (
        json.dumps(SETS).replace("]", ",]"),
        ": line 1: expected OMMs in JSON, got Expecting value",
    ),
    "semicolons": (ROW.replace(",", ";"), ": line 1: expected a column EPOCH, got none"),
    "time system": (csv(omm(TIME_SYSTEM="TAI")), ": line 2: TIME_SYSTEM: expected UTC, got TAI"),
    "centre": (csv(omm(CENTER_NAME="MARS")), ": line 2: CENTER_NAME: expected EARTH, got MARS"),
    "radians": (
        kvn(omm(INCLINATION="0.9", RA_OF_ASC_NODE="6.2", ARG_OF_PERICENTER="0.01", MEAN_ANOMALY="3.1")),
        ": line 8: INCLINATION: expected degrees, and not all four angles between 0 and 6.3, got 0.9",
    ),
    "binary": (bytes(range(256)), ": expected element sets (TLE, OMM), got bytes that are no text"),
    "zeros": (b"\0" * 99, ": expected element sets (TLE, OMM), got bytes that are no text"),
    "utf-16": (
        text(*LINES).encode("utf-16"),
        ": expected element sets (TLE, OMM), got bytes that are no text",
    ),
    "cut gzip": (gzip.compress(text(*LINES).encode(), mtime=0)[:-20], ": expected a file that is whole"),
    "no line 2 at the end": (text(LINES[1], [FIRST]), ": line 3: expected line 2 of a TLE after this line"),
    "no line 1": (text([SECOND], LINES[1]), ": line 1: expected line 1 of a TLE, got '2 12345"),
    "json in a tle": (text(LINES[0], [json.dumps(SETS)]), ": line 3: expected line 1 of a TLE, got"),
    "tle in a json": (
        json.dumps(SETS) + "\n" + text(LINES[0]),
        ": line 2: expected OMMs in JSON, got Extra data",
    ),
    "tle in a kvn": (kvn(SETS[0]) + text(LINES[0]), ": line 20: expected a key for each value, got 1 12345U"),
    "tle in a csv": (csv(SETS[0]) + text(LINES[0]), ": line 3: expected a value for OBJECT_ID, got none"),
    "json cut": (json.dumps(SETS, indent=1)[:-90], ": line 5"),
    "json deep": ("[" * 100_000, ": line 1: expected OMMs in JSON"),
    "microseconds": (csv(omm(EPOCH_MICROSECONDS="1")), ": line 2: EPOCH: expected a time from 1957"),
    "creation": (csv(omm(created="today")), ": line 2: CREATION_DATE: expected a time from 1957 to 2099"),
    "frame": (csv(omm(REF_FRAME="GCRF")), ": line 2: REF_FRAME: expected TEME, got GCRF"),
    "theory": (
        csv(omm(MEAN_ELEMENT_THEORY="SGP4-XP")),
        ": line 2: MEAN_ELEMENT_THEORY: expected SGP4 or SGP",
    ),
}


def first_error(path):
    """Raise the error of the first set that is damaged or does not name its object."""
    for one in mean_elements.read_sets(path):
        element_set.numbered(one)


BASES = {"tle": text(LINES[0]), "json": json.dumps([SETS[0]]), "csv": ROW, "kvn": kvn(SETS[0])}
BASES |= {"xml": xml(SETS[0]), "xmls": xml(*SETS)}


@pytest.mark.parametrize(("notation", "old", "new", "message"), refusals("element_sets"))
def test_an_edit_that_damages_a_set_is_told_in_one_line(written, notation, old, new, message):
    assert old in BASES[notation]
    path = written(BASES[notation].replace(old, new, 1))
    assert refusal(first_error, path).startswith(f"{path}{message}")


def test_a_long_line_is_shown_in_part(read):
    line = refusal(read, " ".join(line for one in LINES for line in one))
    assert len(line.split(", got ")[1]) < 120


@pytest.mark.parametrize(
    ("content", "message"),
    [*refusals("histories"), *(pytest.param(*case, id=name) for name, case in DAMAGED.items())],
)
def test_what_is_damaged_is_told_in_one_line(written, tmp_path, content, message):
    path = tmp_path / "absent" if content is None else written(content)
    assert refusal(first_error, path).startswith(f"{path}{message}")


@pytest.mark.parametrize(
    ("content", "lines"),
    [
        (text(LINES[0], [LINES[1][0]], LINES[2]), [3]),
        (text(LINES[0], [LINES[1][1]], LINES[2]), [3]),
        (text(LINES[0], ["x" + LINES[1][0], LINES[1][1]], LINES[2]), [3]),
        (text(LINES[0], [LINES[1][0], LINES[1][1][:40]], tle(number="00000"), LINES[2]), [4, 5]),
        (json.dumps([SETS[0], omm(BSTAR="?"), 7, SETS[2]], indent=0), [21, 40]),
        (csv(SETS[0], omm(ECCENTRICITY="2"), SETS[2]), [3]),
        (kvn(SETS[0], omm(BSTAR=""), SETS[2]), [37]),
        (xml(SETS[0], omm(BSTAR=""), SETS[2]), [33]),
    ],
    ids=["no line 2", "no line 1", "line 1 moved", "cut, then no orbit", "JSON", "CSV", "KVN", "XML"],
)
def test_damaged_sets_are_left_out_and_told(written, caplog, content, lines):
    path, damaged = written(content), []
    sets = known_sets.readable(path, leave_out_damaged=True)
    np.testing.assert_allclose(times(sets), [0.5 * DAY, 2.5 * DAY], rtol=0, atol=1e-6)
    assert f"damaged sets left out: {len(lines)}, the first: {path}: line {lines[0]}: " in caplog.text
    mean_elements.read_sets(path, damaged)
    places = [str(error).split(": line ")[1].split(":")[0] for error in damaged]
    assert set(places) <= set(map(str, lines))


def test_one_set_in_twenty_may_be_damaged(written, caplog):
    """As fields are blank in a set of TOPEX's history of 1992."""
    good = [csv(omm(day=f"{day:02}")).splitlines() for day in range(1, 22)]
    rows = [good[0][0], *(row for _, row in good)]
    broken = csv(omm(BSTAR="")).splitlines()[1]
    assert len(known_sets.readable(written("\n".join([*rows, broken]) + "\n"))) == 21
    assert "damaged sets left out: 1" in caplog.text
    with pytest.raises(InputError, match="line 23: BSTAR: expected a finite number, got nothing"):
        known_sets.readable(written("\n".join([*rows, broken, broken]) + "\n"))


def test_a_file_that_is_no_list_is_refused_even_where_sets_are_left_out(read):
    with pytest.raises(InputError, match="line 1: expected a column BSTAR, got none"):
        read(ROW.replace("BSTAR", "DRAG"))


@pytest.mark.parametrize(
    ("orbit", "name", "expected"),
    [
        ("cpf/jason3_cpf_180613_16401.cne", "dpshorten_Jason-3", 500.0),
        ("sp3/ssas3a20.b18358.e19003.DG_.sp3.gz", "dpshorten_Sentinel-3A", 700.0),
    ],
)
def test_a_real_orbit_is_where_the_newest_set_has_it(orbit, name, expected):
    files = OrbitFiles([shared(f"real/{orbit}")], "2018-06-01T00:00:00", 230 * DAY)
    (arc,) = read_arcs(files)
    first_day = arc.t < arc.t[0] + DAY
    turns = gcrf_to_itrf(
        earth_orientation.tabulate(files.epoch, nodes(files.epoch, 230 * DAY)), arc.t[first_day]
    )
    history = known_sets.of_object([shared(f"real/tle/{name}.tle.gz")], None)
    newest = [one for one in known_sets.since(files.epoch, history) if one.t <= arc.t[0]][-1]
    found = mean_elements.states(newest.satellite, epoch=files.epoch, t=arc.t[first_day])
    apart = np.einsum("nij,nj->ni", turns, found[:, :3]) - arc.positions[first_day]
    assert np.sqrt((apart**2).sum(axis=1).mean()) < expected


REAL = {
    "dpshorten_CryoSat-2": (4310, 0),
    "dpshorten_Haiyang-2A": (3000, 0),
    "dpshorten_Jason-2": (3923, 0),
    "dpshorten_Jason-3": (2412, 0),
    "dpshorten_SARAL": (3292, 0),
    "dpshorten_Sentinel-3A": (2387, 0),
    "dpshorten_Sentinel-3B": (1584, 0),
    "dpshorten_Sentinel-6A": (665, 0),
    "krama_48445": (716, 235),
    "mfacchinelli_GOCE": (3956, 0),
    "victor_ISS": (609, 0),
    "victor_STARLINK_1007": (276, 0),
}


@pytest.mark.parametrize("name", REAL)
def test_real_histories_are_read_whole(name, caplog):
    history = known_sets.of_object([shared(f"real/tle/{name}.tle.gz")], None)
    known = known_sets.since(EPOCH, history)
    assert (len(known), len(history) - len(known)) == REAL[name]
    assert "damaged" not in caplog.text
    # From the newest set to the next one at its epoch: 60 m for a high orbit, 7 km for one that drops.
    steps = [
        np.subtract(
            *(mean_elements.states(one.satellite, epoch=EPOCH, t=np.array([later.t])) for one in pair)
        )
        for pair in zip(known[50:-1:100], known[51::100], strict=True)
        for later in pair[1:]
    ]
    assert np.median(np.linalg.norm(np.vstack(steps)[:, :3], axis=1)) < 10e3


@pytest.mark.parametrize(
    "change",
    [
        lambda line: f"{line}      0.00      4320.0        360.00",
        lambda line: f"{line}\\",
        lambda line: line[:-1],
    ],
    ids=["times to propagate to", "backslash", "no checksum"],
)
def test_what_programs_add_to_a_line_or_omit_is_no_damage(change, tmp_path):
    given, plain = tmp_path / "given.tle", tmp_path / "plain.tle"
    first, second = tle()
    plain.write_text(f"{first}\n{second}\n")
    given.write_text(f"{change(first)}\n{change(second)}\n")
    (one,), (other,) = mean_elements.read_sets(given), mean_elements.read_sets(plain)
    assert elements(one) == elements(other)


def test_the_verification_of_sgp4_is_read(caplog):
    """30 of its 33 sets have the checksums of their lines."""
    damaged = []
    sets = mean_elements.read_sets(Path(sgp4.__file__).with_name("SGP4-VER.TLE"), damaged)
    assert (len(sets), len(damaged)) == (30, 3)
    assert all("expected the checksum" in str(error) for error in damaged)


def test_columns_that_were_collapsed_are_shown_as_they_are(tmp_path):
    path = tmp_path / "sets.tle"
    path.write_text("\n".join(" ".join(line.split()) for line in tle()))
    told = refusal(mean_elements.read_sets, path)
    assert re.search(
        r"line 1: expected line 1 of a TLE, got '1 12345U 20001A .*: \d\d columns, not 69$", told
    )


@pytest.mark.parametrize(
    ("key", "value"), [("NORAD_CAT_ID", "+12345"), ("REV_AT_EPOCH", "+0"), ("EPHEMERIS_TYPE", "+00")]
)
def test_whole_numbers_may_have_a_sign(key, value, tmp_path):
    (tmp_path / "one.kvn").write_text(kvn(omm(**{key: value})))
    assert mean_elements.read_sets(tmp_path / "one.kvn")[0].number == 12345
