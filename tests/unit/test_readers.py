"""Files from elsewhere, damaged at random: each is read, or refused in one line that names it."""

import json
import re

import numpy as np
import pytest
from damage import DAMAGES, damaged
from hypothesis import given
from support import EPOCH, REPOSITORY

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.yaml_files import read_yaml
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.environment import earth_orientation, gravity_field, solar_activity
from opml.interop import known_orbits, oem
from opml.interop.element_sets import known_sets, mean_elements
from opml.orbits.sheets import read_rsos, read_stations

CONFIG = REPOSITORY / "config"
DAYS = np.array([0.0, 3.0]) * DAY
BULLETIN = """  TABLE 3 ESTIMATES OF 13-MONTH SMOOTH SOLAR ACTIVITY FOR

 2016.7500   SEP    92.0      85.0      79.0      13.0      11.5      10.1
 2016.8337   OCT    91.0      84.0      78.0      12.0      11.0      10.0
 2016.9170   NOV   104.0      90.5      77.0      16.0      12.0       8.0
"""
OMM = """CCSDS_OMM_VERS = 2.0
OBJECT_NAME = VANGUARD 1
OBJECT_ID = 1958-002B
EPOCH = 2016-09-28T12:09:45
MEAN_MOTION = 10.82419157
ECCENTRICITY = 0.1859667
INCLINATION = 34.2682
RA_OF_ASC_NODE = 348.7242
ARG_OF_PERICENTER = 331.7664
MEAN_ANOMALY = 19.3264
EPHEMERIS_TYPE = 0
NORAD_CAT_ID = 5
BSTAR = 0.000028098
MEAN_MOTION_DOT = 2.3e-7
MEAN_MOTION_DDOT = 0
"""
TLE = """VANGUARD 1
1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753
2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667
"""
PAIRS = dict(line.split(" = ") for line in OMM.splitlines())
NOTATIONS = {
    "sets.tle": TLE * 2,
    "sets.json": json.dumps([PAIRS, PAIRS], indent=1),
    "sets.csv": "\n".join(",".join(row) for row in (PAIRS, PAIRS.values(), PAIRS.values())),
    "sets.xml": f"<ndm><omm>{''.join(f'<{key}>{PAIRS[key]}</{key}>' for key in PAIRS)}</omm>\n</ndm>\n",
}
READ = {
    "gravity.gfc": lambda path: gravity_field.read_icgem(path).freeze(EPOCH),
    "msafe.txt": lambda path: solar_activity.tabulate(path, EPOCH, DAYS, 50),
    "weather.csv": lambda path: solar_activity.tabulate(path, EPOCH, DAYS, 50),
    "finals2000A.all": lambda path: earth_orientation.tabulate(EPOCH, DAYS, bulletin=path),
    "iss.oem": lambda path: known_orbits.segments(path, epoch=EPOCH),
    "vanguard.omm": mean_elements.read,
    **dict.fromkeys(NOTATIONS, lambda path: known_sets.by_object([path])),
    "stations.tsv": read_stations,
    "rsos.tsv": read_rsos,
    "config.yaml": read_yaml,
}


def some_lines(path, words):
    """The lines of a long file that hold one of the words."""
    return "".join(line for line in path.read_text().splitlines(True) if any(word in line for word in words))


@pytest.fixture(scope="module")
def files(tmp_path_factory, kepler_model, iss):
    """The bytes of a sound file of every kind that is read, by its name."""
    folder = tmp_path_factory.mktemp("sound")
    gravity = gravity_field.resolve("EGM2008").read_text().replace("max_degree    ", "max_degree ")
    head, rows = gravity.split("end_of_head", 1)
    low = [line for line in rows.splitlines(True)[1:] if int(line.split()[1]) <= 3]
    head = re.sub(r"max_degree\s+\d+", "max_degree 3", head)
    (folder / "gravity.gfc").write_text(f"{head}end_of_head\n{''.join(low)}")
    (folder / "msafe.txt").write_text(BULLETIN)
    weather = solar_activity.resolve("OBSERVED")
    (folder / "weather.csv").write_text(some_lines(weather, ["DATE", "2016-09-2", "2016-09-3", "2016-10-0"]))
    finals = earth_orientation.astropy_iers_data.IERS_A_FILE
    with open(finals, encoding="ascii") as lines:
        (folder / "finals2000A.all").write_text("".join(x for x in lines if x[:4] in ("16 9", "1610")))
    orbit = truth.simulate(Propagator(kepler_model, iss), duration=600.0, step=20.0)
    oem.write(folder / "iss.oem", oem.truth_segments(orbit, rso="iss"), epoch=EPOCH)
    for name, text in {"vanguard.omm": OMM, **NOTATIONS}.items():
        (folder / name).write_text(text)
    for name in ("stations.tsv", "rsos.tsv", "config.yaml"):
        (folder / name).write_bytes((CONFIG / name).read_bytes())
    return lambda name: (folder / name).read_bytes()


def refusal(name, path):
    """What is told of a file that cannot be used; None of one that can."""
    try:
        READ[name](path)
    except InputError as error:
        return str(error)
    return None


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("damaged")


@pytest.mark.parametrize("name", READ)
def test_a_sound_file_is_read(files, folder, name):
    path = folder / name
    path.write_bytes(files(name))
    assert refusal(name, path) is None


@pytest.mark.slow
@pytest.mark.parametrize("name", READ)
@given(damage=DAMAGES)
def test_a_damaged_file_is_read_or_refused_in_one_line(files, folder, name, damage):
    path = folder / name
    path.write_bytes(damaged(files(name), *damage))
    line = refusal(name, path)
    assert line is None or name in line
