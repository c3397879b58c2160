"""Answer a task with the newest sets, by the package sgp4 alone: python plain_sgp4.py TASK ANSWERS.csv"""

import csv
import sys
from pathlib import Path

from sgp4.api import Satrec, jday

task, answers = map(Path, sys.argv[1:])


def epoch(satellite):
    return satellite.jdsatepoch + satellite.jdsatepochF


newest = {}
for path in task.glob("inputs/*/sets.tle"):
    lines = path.read_text().splitlines()
    for pair in zip(lines[::2], lines[1::2], strict=True):
        satellite = Satrec.twoline2rv(*pair)
        key = path.parent.name, satellite.satnum
        newest[key] = max(newest.get(key, satellite), satellite, key=epoch)

with answers.open("w", newline="") as file, (task / "questions.csv").open() as questions:
    writer = csv.writer(file)
    writer.writerow(["object", "t", "time", "frame", "x", "y", "z", "vx", "vy", "vz"])
    for one in csv.DictReader(questions):
        date, clock = one["time"].split("T")
        hour, minute, second = clock.split(":")
        time = jday(*map(int, date.split("-")), int(hour), int(minute), float(second))
        satellite = newest[one["t"].replace(":", ""), int(one["object"])]
        _, position, velocity = satellite.sgp4(*time)  # km, km/s
        state = (1e3 * value for value in (*position, *velocity))
        writer.writerow([one["object"], one["t"], one["time"], "TEME", *state])
