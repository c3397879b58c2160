"""A study of a catalogue: populations of objects, and the spans that a corrector is learned and judged in."""

from typing import Annotated, Literal

from annotated_types import MinLen
from pydantic import Field, Strict

from opml.base.section import Section, absent, setting
from opml.base.setting_types import Absent, Expected, NotNegative, Text, Unique
from opml.study.settings.model.names import Name, PathList

Date = Annotated[
    str,
    Field(pattern=r"^\d{4}-\d{2}-\d{2}$"),
    Expected('a date (UTC) in quotes, like "2026-03-15"'),
]

Dates = Annotated[tuple[Date, Date], Strict(False), Expected("two dates in quotes, the first and the last")]


class PopulationSettings(Section):
    """Objects that learn from each other."""

    files: PathList = setting("files or folders of element sets (TLE, OMM)", unit="path")
    orbits: Absent[Text] = absent(
        "table by `opml orbit` of the orbits inside the sets, which judge where it has them", unit="path"
    )
    label: Absent[Text] = absent("what figures call them; by default the population's name", unit="text")


class SeasonSettings(Section):
    """A season that is learned from, and a later one that judges."""

    population: str = setting("population of the objects that judge", unit="name")
    taught_by: Absent[str] = absent(
        "another population to learn from, in earlier or later mornings", unit="name"
    )
    latency_hours: Absent[NotNegative] = absent("this test's own time from epoch to publication", unit="h")
    train: Dates = setting("mornings of one half of the objects that are learned from")
    test: Dates = setting("later mornings of the other half that judge")

    @property
    def teachers(self) -> str:
        """Population that is learned from."""
        return self.taught_by or self.population


class CatalogueSettings(Section):
    """A study of a catalogue."""

    populations: Annotated[dict[Name, PopulationSettings], MinLen(1)] = setting(
        "objects that learn from each other"
    )
    weather: Text = setting("`OBSERVED` or a CSSI file, which reaches all mornings", unit="name or path")
    latency_hours: NotNegative = setting(
        "time from the epoch of a set to its publication, where the set has no creation date",
        unit="h",
        default=6.0,
    )
    tests: Annotated[dict[Name, SeasonSettings], MinLen(1)] = setting(
        "a season that is learned from, and a later one that judges"
    )
    learners: Annotated[list[Literal["trees", "svr"]], MinLen(1), Unique()] = setting(
        "what learns: boosted trees, the paper's support vector regression",
        unit="names",
        default=["trees", "svr"],
    )

    def words(self, test: str) -> str:
        """Return when a test judges, and whom, in two lines of a figure."""
        season = self.tests[test]
        whom = self.populations[season.population].label or season.population
        late = "" if season.latency_hours is None else f", sets {season.latency_hours:g} h late"
        return f"{season.test[0]} to {season.test[1]}\n{whom}{late}"
