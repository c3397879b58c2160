"""The study of a run: every key, what it means, its unit and its limits."""

from typing import Annotated, Literal

from annotated_types import MinLen

from opml.base.section import Item, Section, absent, setting
from opml.base.setting_types import Absent, Days, Expected, Positive, Share, Text, Unique
from opml.learning.data.cleaning import Cleaning, Previous
from opml.study.settings.model.names import (
    Component,
    CurveName,
    EntryName,
    Fence,
    FigureName,
    Holds,
    Label,
    Names,
    PublishedByRatio,
    PublishedByValue,
    Ratios,
    SeedList,
    Splits,
    Test,
    Tests,
    Train,
)


class ClaimSettings(Item):
    """A claim of the paper, in words, about an entry's numbers."""

    says: Text = setting("what the paper says", unit="text")
    holds: Holds = setting("what then holds of our numbers")
    limit: Absent[float] = absent("number that they are compared with", unit="% or km")
    start: Absent[Positive] = absent("mean error before the correction", unit="km")
    share: Absent[Share] = absent("how far a number may be off, or its residual share")
    beside: Absent[Names] = absent("evaluations whose numbers are shown with the entry's own")
    beyond: Absent[float] = absent("value of a curve from which on the numbers count")


Claims = Annotated[list[ClaimSettings], Expected("a list of claims")]


class Entry(Section):
    """A model on an RSO."""

    stations: Absent[str] = absent("station set, in place of the default one", unit="name", shared=True)
    learner: Absent[str] = absent("learner, in place of the default one", unit="name", shared=True)
    component: Absent[Component] = absent("error component, in place of the default one", shared=True)
    claims: Claims = setting("what the paper says in words", default=[], shared=True)


class TrainAndTestDays(Section):
    """Days of t_j."""

    train: Days = setting("days of t_j to train on")
    test: Days = setting("days of t_j to test on; they follow those to train on")


class Defaults(Section):
    """Defaults of entries."""

    rso: Absent[str] = absent(
        "RSO of every entry that names none; by default the first of `study.rsos`", unit="name"
    )
    stations: Absent[str] = absent(
        "station set of every entry that names none; by default the last of `study.station_sets`", unit="name"
    )
    learner: str = setting("learner of every entry that names none", unit="name", default="svr")
    component: Component = setting("error component of every entry that names none", default="e_y")


class Orbit(Section):
    """Figures of an orbit and its fit."""

    window_day: Positive = setting("day whose next track shows the estimation window", unit="days")
    zoom_days: Days = setting("window of the zoom into the elements")


class EvaluationSettings(Entry):
    """One model on one test."""

    rso: Absent[str] = absent("RSO, in place of the default one", unit="name")
    train: Train = setting("training split", see="wildcards.md")
    test: Test = setting("rows to test on", see="wildcards.md")
    target: Absent[str] = absent("RSO to test on, where it is another one", unit="name")
    label: Absent[Label] = absent("reference of the errors, in place of `study.label`")
    published: Absent[Positive] = absent("the paper's P_ML", unit="%")


class Partition(Entry):
    """A curve of P_ML against the share that is trained on."""

    rso: Absent[str] = absent("RSO, in place of the default one", unit="name")
    ratios: Ratios = setting("shares that are trained on", unit="%")
    shown: Absent[Ratios] = absent("ratios that are figures of their own", unit="%")
    published: PublishedByRatio = setting("the paper's P_ML", unit="%", default={})


class GridSettings(Entry):
    """RSOs side by side."""

    train: Train = setting("training split", see="wildcards.md")
    test: Test = setting("rows to test on", see="wildcards.md")
    rsos: Names = setting("RSOs that are drawn side by side, each trained on itself")


class CurveSettings(Entry):
    """One model on RSOs that differ in one element."""

    rso: Absent[str] = absent("RSO, in place of the default one", unit="name")
    train: Train = setting("training split", see="wildcards.md")
    values: Annotated[list[float], MinLen(1), Unique(), Expected("a list of numbers")] = setting(
        "inclinations, or offsets of the semi-major axis", unit="deg or km"
    )
    tests: Tests = setting("windows to test on, a curve each", see="wildcards.md")
    published: PublishedByValue = setting("the paper's P_ML", unit="%", default={})


class SpreadSeeds(Section):
    """Seeds of the spreads in the reproduction."""

    split: Absent[SeedList] = absent("seeds of the splits that the reproduction states a spread over")
    noise: Absent[SeedList] = absent("seeds of the noise that the reproduction states a spread over")


class ReadingSettings(Section):
    """A reading of what the paper leaves open."""

    text: Text = setting("the interpretation in words", unit="text")
    previous: Absent[Previous] = absent("where t_b is taken from")
    learner: Absent[str] = absent("learner in place of the entries' own", unit="name")
    windows: Absent[Literal["unseen"]] = absent("windows to test on count by t_i, too")
    split: Absent[Literal["random", "grouped"]] = absent("what random splits draw: rows or estimates")
    fence: Absent[Fence] = absent("fences of future tests: none, or of so many IQR from the rows tested")


class ReproductionSettings(Section):
    """The table of the paper's numbers and ours."""

    fixed: str = setting("learner with one fixed kernel scale", unit="name")
    calibrated: str = setting("evaluation that this scale was chosen to meet", unit="name")
    readings: dict[EntryName, ReadingSettings] = setting("an interpretation of an open point of the paper")


class OwnStudySettings(Section):
    """A study of any RSO: models against splits."""

    extends: Absent[str | Names] = absent(
        "in a file, names or paths of studies that this one is laid over", unit="names"
    )
    rsos: Absent[Names] = absent(
        "RSOs that the study is about; by default that of `defaults`, or the first of the sheet"
    )
    station_sets: Absent[Names] = absent(
        "station sets that see them; by default that of `defaults`, or all stations together"
    )
    days: Absent[TrainAndTestDays] = absent("days of t_j to train and to test on")
    splits: Absent[Splits] = absent("in place of `days`, a training and a test split", see="wildcards.md")
    learners: Absent[Names] = absent(
        "models to compare; by default the baselines, `svr`, `covariance`, `mechanism` and `twoarcs`"
    )
    label: Absent[Label] = absent(
        "reference of the errors to learn from: `truth`, or `later` estimates; by default"
        " `truth`, or `later` where an RSO of the study was measured",
        see="labels.md",
    )
    cleaning: Absent[Cleaning] = absent("rows that are dropped; none by default")
    span_days: Absent[Days] = absent(
        "window of t_j that random splits draw from; by default the days to train on, or the run"
    )


class PaperStudy(Section):
    """The paper's figures and tables."""

    defaults: Absent[Defaults] = absent("what entries do not name")
    orbit: Absent[Orbit] = absent("figures of an orbit and its fit")
    distribution: Absent[str] = absent("station set whose true errors are drawn by duration", unit="name")
    evaluations: Absent[Annotated[dict[FigureName, EvaluationSettings], MinLen(1)]] = absent(
        "one model on one test"
    )
    partition: Absent[Partition] = absent("P_ML against the share that is trained on")
    individual: Absent[str] = absent("an evaluation, drawn point by point", unit="name")
    grids: Absent[dict[EntryName, GridSettings]] = absent("RSOs side by side")
    curves: Absent[dict[CurveName, CurveSettings]] = absent("one model on other RSOs")
    seeds: Absent[SpreadSeeds] = absent("seeds of the spreads in the reproduction")
    reproduction: Absent[ReproductionSettings] = absent("the paper's numbers and ours")


class StudySettings(PaperStudy, OwnStudySettings):
    """The study of a run."""
