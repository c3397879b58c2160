"""One measurement in a fresh process, printed as JSON: `python -m benchmarks.probe <what> ...`."""

import json
import sys
import time
from pathlib import Path

from benchmarks import measure

_STATUS = Path("/proc/self/status")


def memory(count: int) -> dict[str, float]:
    """Measure time and growth of memory while `count` arcs are flown on one thread."""
    from benchmarks import case

    model, arcs = case.force_model("assumed"), case.arcs(count)
    case.fly(model, arcs.sample(1))
    before = _resident("VmRSS")
    _forget_peak()
    begin = time.process_time()
    case.fly(model, arcs)
    seconds = time.process_time() - begin
    return {
        "ms_per_arc_day": measure.per_arc_day(seconds, arcs.arc_days),
        "growth_mb": _resident("VmHWM") - before,
        "states_mb": count * count * 48 / 2**20,
    }


def first_step(folder: str) -> dict[str, float]:
    """What a job does before it flies, from tables in `folder`, and one step."""
    from opml.catalog.propagator import Propagator
    from opml.catalog.simulate import truth
    from opml.dynamics import force_model
    from opml.dynamics.settings import ForceModelSettings
    from opml.orbits.sheets import read_rsos
    from opml.tables import ENVIRONMENT

    rso = read_rsos(Path(__file__).parents[1] / "config" / "rsos.tsv")["iss"]
    paths = {name: str(Path(folder) / f"{name}.parquet") for name in ENVIRONMENT}
    settings = ForceModelSettings(degree=40, order=40, third_bodies=["sun", "moon"])
    model = force_model.read(paths, epoch="2016-09-28T12:09:45", settings=settings)
    truth.simulate(Propagator(model, rso), duration=90.0, step=90.0)
    return {}


def _resident(name):
    """Return a figure of the process's memory [MiB], NaN where the system does not tell."""
    lines = _STATUS.read_text().splitlines() if _STATUS.exists() else []
    return next((int(line.split()[1]) / 1024.0 for line in lines if line.startswith(name)), float("nan"))


def _forget_peak():
    clear = Path("/proc/self/clear_refs")
    if clear.exists():
        clear.write_text("5")


def _main():
    _, what, argument = sys.argv
    found = memory(int(argument)) if what == "memory" else first_step(argument)
    print(json.dumps(found))


if __name__ == "__main__":
    _main()
