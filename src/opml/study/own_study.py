"""The experiments of a study of one's own: models against splits on any RSO."""

from dataclasses import dataclass
from functools import cached_property

from opml import naming
from opml.naming import Experiment
from opml.report.own_study import OwnStudyReport, RunFacts
from opml.study.experiments import Study

RUNNING = ("running24m3", "running24", "running48m3", "running", "running96m3", "running96")
"""Laws on the running mean of Cd. Those of one window share their arcs: another memory costs nothing."""

BASELINES = ("none", "fit24", "fit48", "fit96", *RUNNING)
"""Models of what a good engineer would do without learning."""

MODELS = (*BASELINES, "svr", "covariance", "mechanism", "twoarcs")
"""The models that a study compares where it names none."""

MARKS = (1, 2, 4, 7)  # prediction durations that the report states errors at [days]

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

    @cached_property
    def stated(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments whose errors are stated in metres, by RSO, station set and model.

        They are those of the shown split that correct something.
        """
        return {
            (rso, stations, learner): experiment
            for (rso, stations, learner, split), experiment in self.experiments.items()
            if split == self.shown_split and naming.parse_learner(learner, self.study.learners).kind != "none"
        }

    @cached_property
    def report(self) -> OwnStudyReport:
        """Contents of the report."""
        longest = self.study.settings.run.prediction.max_days
        return OwnStudyReport(
            experiments=self.experiments,
            pairs=self.splits,
            shown=self.shown_split,
            datasets=self.datasets,
            learners={name: naming.parse_learner(name, self.study.learners) for name in self.learners},
            component=self.study.defaults["component"],
            label=self.study.label,
            truths=[self.study.truth_of(rso) for rso in self.study.rsos],
            marks=[day for day in MARKS if day <= longest] or [longest],
            settings=RunFacts(**self.study.settings.values),
        )
