"""Make the sample tasks of the benchmark anew: `python tests/reference/benchmark_sample.py`."""

import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
sys.path.insert(0, str(REPOSITORY / "tests"))

import sinking_histories  # noqa: E402

import opml  # noqa: E402
from opml.benchmark import recipes  # noqa: E402
from opml.benchmark.task_folders import Folders, WeatherSources  # noqa: E402
from opml.interop import oem  # noqa: E402

PACKAGED = REPOSITORY / "src" / "opml" / "data" / "benchmark"
OBJECTS, DAYS = range(101, 133), 63
EPOCH = "2016-09-28T12:09:45"


def make(folder):
    """Make the task of sets and its truth, `sample` and `sample-truth`, in a folder."""
    with tempfile.TemporaryDirectory() as temporary:
        sets = Path(temporary, "sets.tle")
        sinking_histories.write(sets, OBJECTS, DAYS)
        return made(folder, "sample", [sets])


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
    return recipes.make(
        recipe, orbits, Folders(Path(folder, name), Path(folder, f"{name}-truth")), WeatherSources()
    )


if __name__ == "__main__":
    print(make(PACKAGED), make_tracks(PACKAGED), "questions")
