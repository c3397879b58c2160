"""gpconf's corpus of element sets under six-digit catalogue numbers: the cases that need no network.

Five of its 18 cases come with the package; the others ask CelesTrak for files of the day. What it grades and
these cases leave out has tests in `tests/unit/interop/test_histories.py`.
"""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from project import HUNG

from opml.interop.element_sets import mean_elements, omm, tle
from opml.interop.element_sets.element_set import PER_DAY, elements_epoch
from opml.interop.object_ids import ObjectId

OFFLINE = {"alpha5-tle-derived", "corrupt-input", "kvn-syntax-variants", "tle-writer-alpha5"}
"""Cases that are graded; a fifth asks for functions of letters alone, which sgp4 has."""

_DAY = 1440.0  # min


class Parser:
    """What gpconf asks: the records of a file, and the refusals with the line that each names."""

    def parse(self, raw, fmt):
        damaged = []
        with TemporaryDirectory() as folder:
            path = Path(folder, "sets")
            path.write_bytes(raw)
            sets = mean_elements.read_sets(path, damaged)
        refused = [_refused(raw.decode().splitlines(), str(error)) for error in damaged]
        return [{"_adapter": {"refusals": True}}, *map(_record, sets), *refused]

    def write_tle(self, record):
        fields = {key.upper(): str(value) for key, value in record.items() if value is not None}
        made = omm.satellite({**fields, "NORAD_CAT_ID": "0"})
        return tle.exported(made, int(fields["NORAD_CAT_ID"]))


def _record(one):
    made = one.satellite
    degrees = {"inclination": made.inclo, "ra_of_asc_node": made.nodeo, "arg_of_pericenter": made.argpo}
    return {
        "norad_cat_id": one.number or None,
        "object_name": one.name or None,
        "object_id": ObjectId.of(one.name, one.designator).designator or None,
        "epoch": elements_epoch(made),
        "mean_motion": made.no_kozai * PER_DAY,
        "mean_motion_dot": made.ndot * PER_DAY * _DAY,
        "mean_motion_ddot": made.nddot * PER_DAY * _DAY**2,
        "eccentricity": made.ecco,
        **{name: math.degrees(angle) for name, angle in degrees.items()},
        "mean_anomaly": math.degrees(made.mo),
        "bstar": made.bstar,
    }


def _refused(lines, error):
    line = lines[int(re.search(r"line (\d+)", error)[1]) - 1]
    columns = dict(zip(lines[0].split(","), line.split(","), strict=False))
    return {"_refused": error, "_input": line, "_field": columns.get("NORAD_CAT_ID", line[2:7])}


def test_every_case_that_needs_no_network_passes(tmp_path):
    report = tmp_path / "report.json"
    (tmp_path / "data").mkdir()
    asked = ["run", "--adapter", "test_gpconf:Parser", "--data", tmp_path / "data", "--json", report]
    command = [sys.executable, "-m", "gpconf", *asked, "--no-fetch-hint"]
    paths = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    subprocess.run(
        command,
        cwd=Path(__file__).parent,
        env=os.environ | paths,
        check=False,
        capture_output=True,
        timeout=HUNG,
    )
    statuses = {one["case"]: one["status"] for one in json.loads(report.read_text())["results"]}
    assert {name for name in OFFLINE if statuses[name].startswith("pass")} == OFFLINE
