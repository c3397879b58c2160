"""Answer a task of tracks by Orekit's batch least squares, without covariances:

    python -m benchmark.orekit_fits TASK FOLDER OREKIT_DATA

State and Cd are fitted over 24 h, from a fit of opml's over 12 h on, and predicted, under Orekit's forces: 48
by 48, Sun, Moon, solid tides, relativity, DTM2000, radiation pressure. Weather and Earth orientation are the
task's, after t as on the last days. OREKIT_DATA is a folder of Orekit's data, for gravity field, leap seconds
and JPL's ephemerides. Runs in the repository, with the extra `verify`.
"""

import multiprocessing
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd

from benchmark.track_fits import AHEAD, FULL, Morning, held_weather, write
from opml.base.constants import HOUR
from opml.benchmark import tasks
from opml.benchmark.answers import REQUIRED
from opml.dynamics.settings import Integrator
from opml.environment.nrlmsis import ap_of_kp
from opml.tables import STATE
from validation import orekit as ok
from validation.case import Case
from validation.estimation import Problem, geometric

WINDOW = 24 * HOUR  # of a fit
FORCES = {**FULL, "third_bodies": ["sun", "moon"]}
INTEGRATOR = Integrator(position_tolerance_m=0.1, min_step_s=1e-3, max_step_s=300.0)
ORIENTATION, WEATHER = "finals2000A.all", "weather.txt"


def cssi(lines):
    """Return lines of a task's weather in the fixed columns of CSSI that Orekit reads."""
    rows = []
    for line in lines:
        day, *cells = line.split(",")
        kp, flux, mean = [int(cell) for cell in cells[:8]], float(cells[8]), float(cells[10])
        ap = ap_of_kp(0.1 * np.array(kp))
        rows.append(
            f"{day.replace('-', ' ')} 2500  1" + "".join(f"{one:3d}" for one in kp) + f"{sum(kp):4d}"
            + "".join(f"{one:4.0f}" for one in ap) + f"{ap.mean():4.0f} 0.5 2  50"
            + f"{flux:6.1f} 0" + (2 * f"{mean:6.1f}") + f"{flux:6.1f}" + (2 * f"{mean:6.1f}")
        )  # fmt: skip
    now = len(rows) - AHEAD - 1
    parts = (("OBSERVED", rows[:now]), ("DAILY_PREDICTED", rows[now:-1]), ("MONTHLY_FIT", rows[-1:]))
    return "\n".join(line for name, part in parts for line in (f"BEGIN {name}", *part, f"END {name}"))


def finals(path):
    """Return a task's Earth orientation in the columns of finals2000A, the day's length held after t."""
    known = pd.read_csv(path)
    ahead = pd.concat([known.iloc[[-1]]] * AHEAD).reset_index(drop=True)
    steps = 1 + np.arange(AHEAD)
    ahead["mjd"] += steps
    ahead["ut1_utc_s"] += steps * known["ut1_utc_s"].diff().iloc[-7:].mean()
    rows = []
    for mjd, x, y, ut1 in pd.concat([known, ahead]).itertuples(index=False):
        day = str(np.datetime64("1858-11-17") + int(mjd))
        rows.append(
            f"{day[2:4]}{day[5:7]}{day[8:]} {mjd:8.2f} I {x:9.6f} 0.000010 {y:9.6f} 0.000010  I{ut1:10.7f}"
            f" 0.0000100  0.0000 0.0100  I {0.0:9.3f} {0.1:8.3f} {0.0:9.3f} {0.1:8.3f}"
        )
    return "\n".join([*rows, ""])


def answers_at(folder, t, asked, data):
    """Return the lines of answers at t, and the seconds that they took, in a process of its own."""
    with tempfile.TemporaryDirectory() as temporary:
        orientation, weather = (Path(temporary, name) for name in (ORIENTATION, WEATHER))
        orientation.write_text(finals(folder / "earth_orientation.csv"))
        weather.write_text(cssi(held_weather(folder)[1:]))
        known = {"Earth orientation": [orientation], "solar activity": [weather]}
        ok.start(ok.Data({**ok.Data.find(data).files, **known}))
        lines = []
        for number, times in asked:
            morning = Morning(folder, number, t, times)
            states = by_orekit(morning).tolist()
            lines += [[number, t, time, "GCRF", *state] for time, state in zip(times, states, strict=True)]
            print(t, number, round(process_time()), file=sys.stderr)
    return lines, process_time()


def by_orekit(morning):
    """Return GCRF states (n, 6) at the times asked."""
    orekit = ok.Orekit(morning.epoch, activity)
    propagator, measured, starts = morning.fits(12, False, 2)
    start = starts[starts["converged"]].iloc[-1]
    rows = measured[(measured["track"] <= start["track"]) & (measured["t"] > start["t"] - WINDOW)]
    stations = {station.name: station for station in morning.stations}
    case = Case({"force_models": {"assumed": FORCES}}, None, {}, stations)
    problem = Problem(orekit, case, morning.rso, propagator.model.gm, INTEGRATOR)
    state = start[STATE].to_numpy(dtype=float)
    fit = problem.fit(start["t"], state, geometric(orekit, problem.measurements(rows)))
    if fit["reason"]:
        raise SystemExit(f"{morning.number} at {morning.t}: {fit['reason']}")
    forces = orekit.forces(FORCES, replace(morning.rso, cd=fit["cd"]))
    state = np.array([fit[name] for name in STATE])
    return orekit.propagate(state, problem.gm, morning.asked, forces, INTEGRATOR, begin=start["t"])


def activity():
    """Return the weather of the task as DTM2000 takes it."""
    return ok.org.orekit.models.earth.atmosphere.data.CssiSpaceWeatherData(WEATHER)


def main(folder, answers, data):
    """Answer all that is asked, each t in a process of its own: a JVM reads its data once."""
    task = tasks.read(folder)
    lines, runtime = [], 0.0
    for t, questions in task.questions.groupby("t"):
        asked = [(number, own["time"].tolist()) for number, own in questions.groupby("object")]
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            part, seconds = pool.submit(answers_at, task.inputs(t), t, asked, Path(data)).result()
        lines, runtime = lines + part, runtime + seconds
    command = f"python -m benchmark.orekit_fits {task.name} . orekit-data"
    path = Path(answers, f"{task.name}_orekit.csv")
    write(path, REQUIRED, lines, f"Orekit {ok.version()}", command, runtime)


if __name__ == "__main__":
    main(*sys.argv[1:])
