"""Make the sample task of the benchmark anew: `python tests/reference/benchmark_sample.py`."""

import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
sys.path.insert(0, str(REPOSITORY / "tests"))

import sinking_histories  # noqa: E402

from opml.benchmark import recipes  # noqa: E402
from opml.environment import solar_activity  # noqa: E402

PACKAGED = REPOSITORY / "src" / "opml" / "data" / "benchmark"
OBJECTS, DAYS = range(101, 133), 63


def make(folder):
    """Make the task and its truth, `sample` and `sample-truth`, in a folder."""
    with tempfile.TemporaryDirectory() as temporary:
        sets = Path(temporary, "sets.tle")
        sinking_histories.write(sets, OBJECTS, DAYS)
        recipe = recipes.read(REPOSITORY / "benchmark" / "sample.yaml")
        task, truth = Path(folder, "sample"), Path(folder, "sample-truth")
        return recipes.make(recipe, [sets], task, truth, weather=solar_activity.OBSERVED)


if __name__ == "__main__":
    print(make(PACKAGED), "questions")
