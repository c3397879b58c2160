"""How opml's ensemble grows: with threads, arcs and RSOs; least squares over a run; the start of a job."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks import case, measure
from opml.base.constants import DAY, GM
from opml.base.seeds import derive
from opml.catalog.associate import quarantine
from opml.catalog.fit import observations, start_states
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.dynamics.ensemble import REASONS, Departures, propagate
from opml.environment import gravity_field
from opml.orbits.elements import TURN, cartesian_from_coe
from opml.tables import write_table

COUNTS = (10, 100, 1000)
RSOS = 1000
PAIRS = 3
_BLOCKS = 20


def threads(progress: Callable[[str], None]) -> str:
    """Compare one thread and two, in turns."""
    model, arcs = case.force_model("assumed"), case.arcs(16 * _BLOCKS)
    case.fly(model, arcs.sample(32), threads=2)
    seconds = {1: [], 2: []}
    for number in range(PAIRS):
        progress(f"threads: pair {number + 1} of {PAIRS}")
        for count, found in seconds.items():
            begin = time.perf_counter()
            case.fly(model, arcs, threads=count)
            found.append(time.perf_counter() - begin)
    rows = [
        [
            str(count),
            measure.figures(measure.per_arc_day(float(np.median(found)), arcs.arc_days)),
            measure.figures(measure.paired_ratio(seconds[1], found), 3),
        ]
        for count, found in seconds.items()
    ]
    return measure.table(["threads", "ms per arc-day, on the clock", "throughput over one thread"], rows)


def arcs(progress: Callable[[str], None]) -> str:
    """Compare few arcs and many on one thread, each number in a process of its own."""
    rows = []
    for count in COUNTS:
        progress(f"{count} arcs")
        found = _probe("memory", str(count))
        rows.append(
            [
                str(count),
                measure.figures(found["ms_per_arc_day"]),
                f"{found['growth_mb']:.0f}",
                f"{found['states_mb']:.1f}",
            ]
        )
    return measure.table(
        ["arcs", "ms per arc-day, CPU", "memory grows by [MiB]", "of which states [MiB]"], rows
    )


def rsos(progress: Callable[[str], None]) -> tuple[str, float]:
    """Return a sentence on a thousand different orbits as one ensemble, and its ms per arc-day."""
    progress(f"{RSOS} RSOs")
    model = case.force_model("assumed")
    states = _population(model.gm)
    epochs = np.linspace(0.0, case.DAYS * DAY, 101)
    rso = case.paper().rsos["iss"]
    begin = time.process_time()
    flown = propagate(
        model,
        epochs,
        Departures(
            states,
            first=np.zeros(RSOS, int),
            last=np.full(RSOS, 100),
            ballistic=np.full(RSOS, rso.cd * rso.area_to_mass),
            reflection=np.full(RSOS, rso.cr * rso.area_to_mass),
        ),
        integrator=case.paper().integrator,
    )
    cost = measure.per_arc_day(time.process_time() - begin, RSOS * case.DAYS)
    lost = {REASONS[k]: int(n) for k, n in enumerate(np.bincount(flown.status)) if k and n}
    text = (
        f"{RSOS} RSOs between 300 and 2000 km, eccentricity up to 0.02, any inclination, seven days from one "
        f"epoch as one ensemble: {measure.figures(cost)} ms per arc-day of CPU"
    )
    return text + (f"; lost: {lost}.\n" if lost else "; none lost.\n"), cost


def _population(gm):
    """Return states (RSOS, 6) of circular-like orbits of a low catalogue, drawn with the run's seed."""
    rng = derive(case.paper().values["seed"]["noise"], "benchmarks", "rsos")
    perigee, e = rng.uniform(300e3, 2000e3, RSOS), rng.uniform(0.0, 0.02, RSOS)
    a = (6378137.0 + perigee) / (1.0 - e)
    i = np.arccos(rng.uniform(-1.0, 1.0, RSOS))
    argp, raan, nu = rng.uniform(0.0, TURN, (3, RSOS))
    return cartesian_from_coe(np.stack([a, e, i, argp, raan, nu], axis=1), gm)


def least_squares(progress: Callable[[str], None]) -> str:
    """Time all estimates of the paper's three-station case, on two threads."""
    paper, days = case.paper(), case.paper().values["duration_days"]
    rso, stations = paper.rsos["iss"], list(paper.stations.values())
    progress(f"truth of {days} days")
    begin = time.perf_counter()
    true = truth.simulate(
        Propagator(case.force_model("truth", days=days), rso, paper.integrator),
        duration=paper.duration,
        step=paper.values["tracking"]["step_s"],
    )
    truth_seconds = time.perf_counter() - begin
    seed, orientation = paper.values["seed"]["noise"], case.environment(days)["earth_orientation"]
    tracks = tracking.simulate(true, orientation, stations, rso=rso.name, seed=seed)
    progress("least squares")
    begin = time.perf_counter()
    found = quarantine.estimate_all(
        Propagator(case.force_model("assumed", days=days), rso, paper.integrator, threads=2),
        start_states.perturbed(true, tracks, rso=rso.name, settings=paper.estimation, seed=seed),
        observations.Measured(tracks, orientation, stations),
        settings=paper.estimation,
    )
    seconds = time.perf_counter() - begin
    iterations = int(found["iterations"].sum())
    rows = [
        ["true orbit, one arc, 20 s grid, one thread", f"{truth_seconds:.1f} s"],
        [f"{len(found)} estimates ({found['converged'].sum()} converged), two threads", f"{seconds:.1f} s"],
        [
            f"an iteration of one window of 8 lanes ({iterations} in all)",
            f"{1e3 * seconds / iterations:.1f} ms",
        ],
    ]
    return measure.table(["three stations, 50 days", "on the clock"], rows)


def start(progress: Callable[[str], None]) -> str:
    """Time a job's start up to its first step, with kernels compiled before and without."""
    progress("start of a job")
    with tempfile.TemporaryDirectory() as folder:
        _write_environment(Path(folder))
        with tempfile.TemporaryDirectory() as cache:
            cold = _seconds("first_step", folder, OPML_CACHE=cache)
            warm = min(_seconds("first_step", folder, OPML_CACHE=cache) for _ in range(3))
    rows = [
        ["warm: interpreter, imports, tables, first step", f"{warm:.1f} s"],
        ["cold: the same, and the kernels compiled", f"{cold:.1f} s"],
    ]
    return measure.table(["start of a job that flies", "on the clock"], rows)


def _write_environment(folder):
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008")).truncate(40, 40)
    frames = case.environment(2 * case.DAYS) | {
        "gravity_field": gravity_field.table(field, case.paper().epoch)
    }
    extra = {"gravity_field": gravity_field.metadata(field), "ephemerides": {"gm": GM}}
    for name, frame in frames.items():
        write_table(folder / f"{name}.parquet", frame, name, metadata=extra.get(name, {}))


def _seconds(*arguments, **environment):
    begin = time.perf_counter()
    _probe(*arguments, **environment)
    return time.perf_counter() - begin


def _probe(*arguments, **environment):
    command = [sys.executable, "-m", "benchmarks.probe", *arguments]
    done = subprocess.run(command, env=os.environ | environment, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)
