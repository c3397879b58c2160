"""The experiments of a study of one's own: models against splits on any RSO, replayed mornings, fits."""

from dataclasses import dataclass
from functools import cached_property

from opml import naming
from opml.learning.data.error_components import CORRECTED
from opml.learning.judge.calibration import marks
from opml.learning.models.daily_training import first_day
from opml.learning.models.learners import learns, resolved
from opml.naming import Experiment
from opml.report.answer import ALL_MODELS, Sources
from opml.report.own_study import OwnStudyReport, RunFacts
from opml.study.experiments import FILES, MEASURED, SIMULATED, Study

RUNNING = ("running24m3", "running24", "running48m3", "running", "running96m3", "running96")
"""Laws on the running mean of Cd. Those of one window share their arcs: another memory costs nothing."""

BASELINES = ("none", "fit24", "fit48", "fit96", *RUNNING)
"""Models of what a good engineer would do without learning."""

MODELS = (*BASELINES, "svr", "covariance", "mechanism", "twoarcs")
"""The models that a study compares where it names none."""

MARKS = (1, 2, 4, 7)  # prediction durations that the report states errors at [days]

REPLAYED = (
    *("none", "fit48", "fit96", *RUNNING),
    *("covariance", "mechanism", "twoarcs"),
)
"""The models whose mornings are replayed where a study names none: they are trained in seconds."""

GROUPED, LATER, UNSEEN = "grouped", "later", "unseen"


@dataclass(frozen=True)
class OwnStudy:
    """The experiments of a study that names RSOs, station sets, and days to train and test on, or splits."""

    study: Study

    @property
    def is_asked(self) -> bool:
        """Whether the study says what to train and to test on."""
        return "days" in self.study or "splits" in self.study

    @cached_property
    def splits(self) -> dict[str, tuple[str, str]]:
        """Training and test rows by the split's name: the study's own, else three by its days."""
        if "splits" in self.study:
            return {name: tuple(pair) for name, pair in self.study.entry("splits").items()}
        train, test = (naming.days_split(self.study.entry("days")[part]) for part in ("train", "test"))
        return {
            GROUPED: ("grouped-80", "rest"),
            LATER: (train, test),
            UNSEEN: (train, naming.unseen_test(test)),
        }

    @cached_property
    def shown_split(self) -> str:
        """The split whose errors are drawn and stated.

        The first whose predictions start after the training; else the first of later days; else the first.
        """
        tests = {name: naming.parse_test(test) for name, (_, test) in self.splits.items()}
        unseen = [name for name, test in tests.items() if test.starts_inside]
        later = [name for name, test in tests.items() if test.kind == "days"]
        return [*unseen, *later, *self.splits][0]

    @cached_property
    def learners(self) -> list[str]:
        """The models that are compared."""
        settings = self.study.learners
        known = [name for name in MODELS if name in settings]
        return list(self.study.settings.study.get("learners") or known)

    @cached_property
    def datasets(self) -> list[tuple[str, str]]:
        """RSO and station set of every dataset."""
        return [(rso, stations) for rso in self.study.rsos for stations in self.study.station_sets]

    @cached_property
    def datasets_with_truth(self) -> list[tuple[str, str]]:
        """RSO and station set of the datasets that are learned from labels while the truth is known."""
        if self.study.label == "truth":
            return []
        return [(rso, stations) for rso, stations in self.datasets if self.study.has_truth(rso)]

    @cached_property
    def experiments(self) -> dict[tuple[str, str, str, str], Experiment]:
        """The experiments by RSO, station set, model and split."""
        return {
            (rso, stations, learner, split): self.study.experiment(
                {}, rso=rso, stations=stations, learner=learner, train=train, test=test
            )
            for rso, stations in self.datasets
            for learner in self.learners
            for split, (train, test) in self.splits.items()
        }

    @property
    def panels(self) -> list[str]:
        """Station sets as the metrics name them, with the suffix of their labels."""
        columns = (experiment.columns() for experiment in self.experiments.values())
        return list(dict.fromkeys(names["stations"] for names in columns))

    def corrections(self, rso: str, stations: str) -> dict[str, Experiment]:
        """Return the experiments of the shown split that correct something, by model."""
        return {
            learner: self.experiments[rso, stations, learner, self.shown_split]
            for learner in self.learners
            if naming.parse_learner(learner, self.study.learners).kind != "none"
        }

    @cached_property
    def stated(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments whose errors are stated in metres, by RSO, station set and model."""
        return {
            (rso, stations, learner): experiment
            for rso, stations in self.datasets
            for learner, experiment in self.corrections(rso, stations).items()
        }

    @cached_property
    def replayed_models(self) -> list[str]:
        """The models whose mornings are replayed; none without days to train on."""
        if not self.is_asked:
            return []
        train, _ = self.splits[self.shown_split]
        if naming.parse_train(naming.strip_seed(train, naming.SPLIT)).kind != "days":
            return []
        run = self.study.settings.run
        last = float(run.duration_days) - 3.0  # two more mornings have to be over then
        days = naming.parse_train(naming.strip_seed(train, naming.SPLIT)).days
        hours = run.estimation.window_hours

        def begins(name: str) -> float:
            own = naming.parse_learner(name, self.study.learners)
            learner = resolved(own, component=CORRECTED, variables=())
            return first_day(learner, window_hours=hours, train_days=days)

        return self.study.settings.study.get("replayed") or [
            name for name in REPLAYED if name in self.learners and begins(name) <= last
        ]

    @cached_property
    def replayed(self) -> dict[tuple[str, str, str], dict[str, str]]:
        """Parts of the replays' names, by RSO, station set and model."""
        train, label = self.splits[self.shown_split][0], naming.LABELS[self.study.label]
        shared = {"window": "", "reading": "", "label": label, "train": train}
        return {
            (rso, stations, learner): {"rso": rso, "stations": stations, **shared, "learner": learner}
            for rso, stations in self.datasets
            for learner in self.replayed_models
        }

    def mornings(self, rso: str, stations: str) -> dict[str, dict[str, str]]:
        """Return the parts of the names of a dataset's replays, by model."""
        replayed = self.replayed.items()
        return {learner: parts for (*dataset, learner), parts in replayed if dataset == [rso, stations]}

    @property
    def laws(self) -> list[str]:
        """The models that learn, among those whose mornings are replayed."""
        names = dict.fromkeys(learner for *_, learner in self.replayed)
        return [name for name in names if learns(naming.parse_learner(name, self.study.learners))]

    @property
    def replayed_datasets(self) -> list[tuple[str, str]]:
        """RSO and station set of the datasets whose mornings are replayed."""
        return [dataset for dataset in self.datasets if self.mornings(*dataset)]

    @cached_property
    def windows(self) -> dict[str, str]:
        """Suffixes of the windows of the run's fits and of the fits that models need, by a figure's label."""
        default = float(self.study.settings.run.estimation.window_hours)
        needed = {
            float(hours)
            for name in self.learners
            if (hours := naming.parse_learner(name, self.study.learners).get("window_hours"))
        }
        return {
            f"{hours:g}-hour fits": naming.window_suffix(hours, default=default)
            for hours in (default, *sorted(needed - {default}))
        }

    @property
    def marks(self) -> list[float]:
        """Prediction durations that errors are stated at [days]."""
        longest = self.study.settings.run.prediction.max_days
        return [day for day in MARKS if day <= longest] or [longest]

    @cached_property
    def report(self) -> OwnStudyReport:
        """Contents of the report."""
        return OwnStudyReport(
            experiments=self.experiments,
            pairs=self.splits,
            shown=self.shown_split,
            stated=self.stated,
            datasets=self.datasets,
            learners={name: naming.parse_learner(name, self.study.learners) for name in self.learners},
            component=self.study.defaults["component"],
            label=self.study.label,
            truths=[self.study.truth_of(rso) for rso in self.study.rsos],
            laws=self.laws,
            seed=self.study.settings.run.seed.split,
            marks=self.marks,
            durations=marks(self.study.settings.run.prediction.max_days),
            sources={dataset: self._sources(*dataset) for dataset in self.datasets},
            settings=RunFacts(**self.study.settings.values),
        )

    def _sources(self, rso: str, stations: str) -> Sources:
        """Return what the report's answer points at; figures are linked to as seen from the report."""
        run, (train, test) = self.study.settings.run, self.splits[self.shown_split]
        first, last = naming.parse_train(naming.strip_seed(train, naming.SPLIT)).days
        later = naming.parse_test(test)
        end = later.days[1] if later.kind == "days" else last
        days = naming.days_split((first, end))
        label, models = naming.LABELS[self.study.label], self.mornings(rso, stations)
        folder = f"{run.results}/corrected/{rso}/{stations}{label}/{days}"
        figures = {
            **({ALL_MODELS: f"study/{rso}/{stations}_residuals"} if models else {}),
            "P_ML": f"study/{rso}/models",
            "Cd and the weather": f"study/{rso}/{stations}_drag",
        }
        return Sources(
            files={name: f"{folder}/{name}.oem" for name in models},
            day=end,
            end=run.duration_days,
            manoeuvres={
                MEASURED: f"named in `manoeuvres`: {len(self.study.settings.manoeuvres(rso))}",
                FILES: "those that the orbit's files mark are known",
                SIMULATED: "",
            }[MEASURED if self.study.is_measured(rso) else self.study.truth_of(rso)],
            figures={shows: f"figs/{name}.png" for shows, name in figures.items()},
        )
