"""opml's least squares under the paper's assumed model."""

from benchmarks import case, windows
from benchmarks.windows import Answers, Windows
from opml import __version__
from opml.catalog.fit.least_squares import Fit


class Opml:
    """The product as the workflow runs it."""

    title = f"opml {__version__}"
    model = "EGM2008 20x20, Sun, Moon, Jupiter (DE440), DTM2000 with MSAFE, radiation pressure with shadow"
    method = "state and Cd, neighbouring arcs"
    way = "16 windows side by side, steps ≤ 90 s"
    share = 16

    def __init__(self):
        self.forces = case.force_model("assumed")

    def prepare(self, fitted: Windows) -> None:
        """Find out nothing: the settings are known."""

    def fit(self, fitted: Windows) -> Answers:
        """Fit state and Cd."""
        return windows.answers(self.twin(fitted))

    def twin(self, fitted: Windows) -> list[Fit]:
        """Return the same fits with all that they hold."""
        return windows.fit(self.forces, fitted)
