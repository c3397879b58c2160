"""The run: what is simulated, and how learners learn. Every key, what it means, its unit and its limits."""

import os
from typing import Annotated, Self, get_args

from annotated_types import Ge, Le, Lt, MinLen

from opml.base.section import Section, absent, setting
from opml.base.setting_types import Absent, Expected, NotNegative, Positive, Text, Unique
from opml.catalog.fit.estimation_settings import EstimationSettings
from opml.dynamics.settings import ForceModels, Integrator
from opml.environment.settings import EnvironmentSettings
from opml.interop.points_from_files import FixSettings
from opml.learning.models.learners import AnyLearner
from opml.study.settings.model.names import (
    Epoch,
    Folder,
    Name,
    PathList,
    ResonanceList,
    RsoName,
    Seed,
    Times,
    Variables,
)


class RandomSeeds(Section):
    """Seeds of random numbers."""

    noise: Seed = setting(
        "seed of the measurement noise, and of the perturbed states that first fits start from"
    )
    split: Seed = setting("seed of the random splits and of the learners' subsamples")


class Tracking(Section):
    """Measurements."""

    step_s: Positive = setting("time between measurements, and of the truth's grid", unit="s")


class RangeSettings(Section):
    """Reading of an RSO's laser ranges."""

    coordinates: Text = setting("SINEX of the stations' coordinates and velocities", unit="path")
    eccentricities: Text = setting("SINEX of the instruments' offsets from the marks", unit="path")
    reflectors_m: NotNegative = setting(
        "how far the reflectors are before the centre of mass, seen from a station", unit="m"
    )
    sigma_m: Positive = setting(
        "least standard deviation of a normal point; the scatter of its ranges counts where it is larger",
        unit="m",
        default=0.02,
    )
    without: Annotated[list[Annotated[int, Ge(1)]], Unique(), Expected("numbers of stations")] = setting(
        "stations whose ranges are skipped", unit="numbers", default=[]
    )

    @property
    def files(self) -> list[str]:
        """Positions of stations: coordinates, then eccentricities."""
        return [self.coordinates, self.eccentricities]

    def within(self, folder: str) -> Self:
        """Return the same with relative paths in a folder."""
        coordinates, eccentricities = (os.path.join(folder, path) for path in self.files)
        return self.model_copy(update={"coordinates": coordinates, "eccentricities": eccentricities})


class HistorySettings(Section):
    """Reading of the history of an RSO's mean elements."""

    number: Absent[Annotated[int, Ge(1), Expected("a catalogue number from 1")]] = absent(
        "catalogue number of the RSO, needed where the files hold several objects"
    )


class PredictionSettings(Section):
    """Predictions."""

    max_days: Positive = setting("longest prediction", unit="days")


class Learning(Section):
    """Settings that all learners share."""

    variables: Variables = setting(
        "variables that learners learn from, where their own settings name none",
        unit="names",
        see="data/learning.md#dataset",
    )


class Mechanism(Section):
    """Columns that laws learn from."""

    long_window_hours: Positive = setting("window of the long arc of each estimate", unit="h")
    resonances: ResonanceList = setting(
        "resonances that may be learned from: nodal days and revolutions", unit="pairs (k, m)"
    )


MORNING_MODELS = ("fit48", "fit96", "running24m3", "running24", "running", "running96")
"""Models that a morning chooses from where none are named."""


class DaySettings(Section):
    """Every morning."""

    models: Absent[Annotated[list[Name], MinLen(1), Unique()]] = absent(
        f"models that a morning chooses from, of those that learn nothing; by default "
        f"{', '.join(MORNING_MODELS)}; element sets are predicted as by `opml predict`",
        unit="names",
    )
    hour: Annotated[float, Ge(0), Lt(24), Expected("an hour from 0 to below 24")] = setting(
        "time of a morning, UTC", unit="h", default=0.0
    )
    together: Annotated[int, Ge(1), Expected("a whole number from 1")] = setting(
        "objects that one job takes at most; their arcs are integrated in step", default=64
    )
    step_s: Annotated[float, Ge(1), Le(300), Expected("seconds from 1 to 300")] = setting(
        "time between the epochs of an ephemeris, which are counted from the run's; it reaches"
        " `prediction.max_days` ahead, as far as the run does",
        default=60.0,
    )
    futures: Annotated[int, Ge(2), Expected("a whole number of 2 or more")] = setting(
        "futures of the weather that covariances know of, with `knowledge: forecast`", default=30
    )
    messages: Absent[Annotated[list[Name], Unique()]] = absent(
        "objects whose ephemerides are also written as OEM; by default all", unit="names"
    )
    passes: list[Text] = setting(
        "places over which passes are written beside each OEM: latitude,longitude,altitude, as 52.2,21.0,110",
        unit="deg, m",
        default=[],
    )


class Sheets(Section):
    """The sheets."""

    stations: str = setting("sheet of the stations", unit="path", see="#sheets")
    rsos: str = setting("sheet of the RSOs", unit="path", see="#sheets")


class RunAlone(Section):
    """A run, without its study."""

    results: Folder = setting("folder of all that is written")
    seed: RandomSeeds = setting("where random numbers begin")
    epoch: Epoch = setting("epoch of the RSOs' elements and start of the run")
    duration_days: Positive = setting("how long the truth is propagated", unit="days")
    environment: EnvironmentSettings = setting("Earth, Sun, Moon, weather, and what is known of them")
    force_models: ForceModels = setting("the truth's force model, and that of fits and predictions")
    integrator: Integrator = setting("the Dormand-Prince 8(5,3) method")
    tracking: Tracking = setting("measurements")
    estimation: EstimationSettings = setting("fits of an orbit and a drag coefficient to tracks")
    prediction: PredictionSettings = setting("predictions")
    learning: Learning = setting("what all learners share")
    learners: Annotated[dict[Name, AnyLearner], MinLen(1)] = setting(
        "a learner: its `kind`, and that kind's own settings; `variables` replaces the default ones,"
        " `without` leaves some of them out",
        see="howto.md#a-learner",
    )
    mechanism: Mechanism = setting("columns that laws learn from")
    day: Absent[DaySettings] = absent("every morning", see="day.md")
    sheets: Sheets = setting("the sheets")
    stations: dict[Name, dict[str, float]] = setting(
        "a station in addition to the sheet: the columns of a sheet's row as keys",
        unit="mapping",
        see="#sheets",
        default={},
    )
    rsos: dict[Name, dict[str, float]] = setting(
        "an RSO in addition to the sheet: the columns of a sheet's row as keys",
        unit="mapping",
        see="#sheets",
        default={},
    )
    data: Text = setting(
        "folder that relative paths of orbits, measurements, `starts` and `manoeuvres` start from; else the"
        " project",
        unit="path",
        default="",
    )
    orbits: dict[RsoName, PathList] = setting(
        "files of an orbit that replaces the RSO's simulated truth (SP3, CPF or OEM), one orbit together;"
        " the RSO's entry then needs its body only",
        see="orbits.md",
        default={},
    )
    tracks: dict[RsoName, PathList] = setting(
        "tracks that were really measured, in place of simulated ones (CCSDS TDM); the RSO's entry may be"
        " its body only",
        see="tracks.md",
        default={},
    )
    fixes: dict[RsoName, PathList] = setting(
        "positions that were measured, in the place of `tracks` (CSV, SP3, CPF or OEM)",
        see="tracks.md#fixes",
        default={},
    )
    fixing: dict[RsoName, FixSettings] = setting(
        "how these are weighed, thinned and gathered, where not by default", see="tracks.md#fixes", default={}
    )
    ranges: dict[RsoName, PathList] = setting(
        "laser ranges that were measured, normal points, in the place of `tracks` (CRD)",
        see="tracks.md#laser-ranges",
        default={},
    )
    ranging: dict[RsoName, RangeSettings] = setting(
        "where their stations are, and how they are weighed", see="tracks.md#laser-ranges", default={}
    )
    elements: dict[RsoName, PathList] = setting(
        "histories of mean elements (TLE, OMM), for mornings (`day`)", see="elements.md", default={}
    )
    histories: dict[RsoName, HistorySettings] = setting(
        "which object these are of, where the files hold several", see="elements.md", default={}
    )
    starts: dict[RsoName, Text] = setting(
        "where the first orbit of an RSO that was measured starts: a TLE, OMM, OEM, SP3 or CPF; by default"
        " its elements, or it is determined from the tracks",
        unit="path",
        see="tracks.md",
        default={},
    )
    manoeuvres: dict[RsoName, Times] = setting(
        "known manoeuvres of an RSO with tracks, fixes or ranges", see="tracks.md#burns", default={}
    )


def reading_options(name: str) -> type[Section]:
    """Return the section of an RSO's entry in a setting with options of reading; an empty one for ''."""
    return get_args(RunAlone.model_fields[name].annotation)[1] if name else Section
