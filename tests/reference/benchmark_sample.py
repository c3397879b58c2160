"""Make the sample tasks of the benchmark anew: `python tests/reference/benchmark_sample.py`."""

import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).parents[2]
sys.path.insert(0, str(REPOSITORY / "tests"))

import sinking_histories  # noqa: E402

import opml  # noqa: E402
from opml.base import epochs  # noqa: E402
from opml.benchmark import recipes, set_truths  # noqa: E402
from opml.benchmark.task_folders import Folders  # noqa: E402
from opml.element_sets import density  # noqa: E402
from opml.environment import known_weather  # noqa: E402
from opml.interop import oem  # noqa: E402

PACKAGED = REPOSITORY / "src" / "opml" / "data" / "benchmark"
OBJECTS, DAYS = range(101, 133), 63
EPOCH = "2016-09-28T12:09:45"


def make(folder):
    """Make the task of sets and its truth, `sample` and `sample-truth`, in a folder."""
    with tempfile.TemporaryDirectory() as temporary:
        sets = Path(temporary, "sets.tle")
        lines = [sinking_histories.sets_of(one, DAYS, densities=densities_of(one)) for one in OBJECTS]
        sets.write_text("\n".join(line for own in lines for line in own) + "\n")
        return made(folder, "sample", [sets])


@cache
def densities():
    """Logarithms of mean densities (days, heights), after the measured weather that of its last day."""
    weather = density.clean(known_weather.read("OBSERVED"))
    first = int(epochs.mjd(sinking_histories.FIRST))
    log = density.measured(weather, first, weather.end).log
    daily = log[: len(log) // density.QUARTERS * density.QUARTERS]
    daily = daily.reshape(-1, density.QUARTERS, log.shape[1]).mean(axis=1)
    return daily[np.minimum(np.arange(DAYS), len(daily) - 1)]


def densities_of(number):
    """Densities (days,) at an object's height, relative to their mean."""
    height = sinking_histories.height_of(number)
    rho = np.exp([np.interp(height, density.HEIGHTS, log) for log in densities()])
    return rho / rho.mean()


def make_tracks(folder):
    """Make the task of tracks, `sample-tracks`, through the weather that was measured."""
    environment = opml.make_environment(EPOCH, days=12, activity="OBSERVED")
    rsos = opml.read_rsos("config/rsos.tsv")
    with tempfile.TemporaryDirectory() as temporary:
        for name in ("iss", "larets"):
            propagator = opml.Propagator(opml.force_model(environment, **opml.TRUTH), rsos[name])
            truth = opml.propagate(propagator, days=12, step=120.0)
            oem.write(
                Path(temporary, f"{name}.oem"), oem.truth_segments(truth, rso=name), epoch=environment.epoch
            )
        return made(folder, "sample-tracks", sorted(Path(temporary).iterdir()))


def made(folder, name, orbits):
    """Make a task of its recipe; the number of questions."""
    recipe = recipes.read(REPOSITORY / "benchmark" / f"{name}.yaml")
    folders = Folders(Path(folder, name), Path(folder, f"{name}-truth"))
    return recipes.make(recipe, orbits, folders, judge=set_truths.themselves)


if __name__ == "__main__":
    print(make(PACKAGED), make_tracks(PACKAGED), "questions")
