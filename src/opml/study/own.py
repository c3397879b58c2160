"""A study of any RSO: models against splits, errors before and after correction, rows used and dropped."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from opml import naming
from opml.errors import InputError
from opml.learning.origins import origins
from opml.learning.paths import CORRECTED, UNCORRECTED
from opml.naming import Experiment
from opml.report.study import Answer
from opml.study.experiments import Study

BASELINES = ("none", "repredicted", "fit24", "fit48", "fit96", "held", "running")
"""What a good engineer would do without learning."""

MODELS = (*BASELINES, "svr", "covariance", "mechanism", "twoarcs")
"""The models that a study compares where it names none."""

MARKS = (1, 2, 4, 7)
"""Prediction durations that the report states errors at [days]."""

CALIBRATED = ("none", "running", "covariance", "mechanism", "twoarcs")
"""The models whose uncertainty is tested where a study names none: they are trained in seconds."""

GROUPED, LATER, UNSEEN = "grouped", "later", "unseen"

PAST_SHARE = 2.0 / 3.0
"""How much of the days to train on is trained on where the rest of them chooses among the models."""

LEAST_PAST = 3.0
"""Fewest days to train on of which a part can choose [days]."""


@dataclass(frozen=True)
class Own:
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
            UNSEEN: (train, naming.as_unseen(test)),
        }

    @cached_property
    def shown(self) -> str:
        """The split whose errors are drawn and stated in metres: the first that is tested on later days."""
        later = [name for name, (_, test) in self.splits.items() if naming.as_unseen(test) != test]
        return [*later, *self.splits][0]

    @cached_property
    def learners(self) -> list[str]:
        """The models that are compared."""
        known = [name for name in MODELS if name in self.study.learners]
        return list(self.study.settings.asked.get("learners") or known)

    @cached_property
    def datasets(self) -> list[tuple[str, str]]:
        """RSO and station set of every dataset."""
        return [(rso, stations) for rso in self.study.rsos for stations in self.study.station_sets]

    @cached_property
    def experiments(self) -> dict[tuple[str, str, str, str], Experiment]:
        """The experiments by RSO, station set, model and split."""
        return self._of_splits(self.splits)

    def _of_splits(
        self, splits: Mapping[str, tuple[str, str]]
    ) -> dict[tuple[str, str, str, str], Experiment]:
        return {
            (rso, stations, learner, split): self.study.experiment(
                {}, rso=rso, stations=stations, learner=learner, train=train, test=test
            )
            for rso, stations in self.datasets
            for learner in self.learners
            for split, (train, test) in splits.items()
        }

    @cached_property
    def past(self) -> dict[str, tuple[str, str]]:
        """Training and test rows within the days to train on, by the split whose model they choose."""
        return {name: _past(*pair) for name, pair in self.splits.items() if _has_past(*pair)}

    @cached_property
    def trials(self) -> dict[tuple[str, str, str, str], Experiment]:
        """The experiments on the past by RSO, station set, model and the split that they choose for."""
        return self._of_splits(self.past)

    @property
    def panels(self) -> list[str]:
        """Station sets as the metrics name them, with what errors are held against."""
        return list(dict.fromkeys(one.columns()["stations"] for one in self.experiments.values()))

    def drawn(self, rso: str, stations: str) -> dict[str, Experiment]:
        """The experiments of the shown split that correct something, by model."""
        return {
            learner: self.experiments[rso, stations, learner, self.shown]
            for learner in self.learners
            if naming.parse_learner(learner, self.study.learners)["kind"] != "none"
        }

    @cached_property
    def stated(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments whose errors are stated in metres, by RSO, station set and model."""
        return {
            (rso, stations, learner): one
            for rso, stations in self.datasets
            for learner, one in self.drawn(rso, stations).items()
        }

    @cached_property
    def rolling(self) -> dict[tuple[str, str, str], Experiment]:
        """Learners that are trained anew, by RSO, station set and learner: those that the study names."""
        train, test = self.splits[self.shown]
        return {
            (rso, stations, learner): self.study.experiment(
                {}, rso=rso, stations=stations, learner=learner, train=train, test=test
            )
            for rso, stations in self.datasets
            for learner in self.study.entry("rolling").get("learners", [])
        }

    @cached_property
    def calibrated(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments whose uncertainty is tested, by RSO, station set and model."""
        named = self.study.settings.asked.get("calibrated") or [
            name for name in CALIBRATED if name in self.learners
        ]
        train, test = self.splits[self.shown]
        return {
            (rso, stations, learner): self.study.experiment(
                {}, rso=rso, stations=stations, learner=learner, component=CORRECTED, train=train, test=test
            )
            for rso, stations in self.datasets
            for learner in (() if self.without_past else named)
        }

    @cached_property
    def without_past(self) -> str:
        """Why no uncertainty can be told from the past of the shown split, empty where it can."""
        train, _ = self.splits[self.shown]
        values = self.study.settings.values
        try:
            origins(
                naming.without_seed(train, naming.SPLIT),
                longest_days=values["prediction"]["max_days"],
                block_hours=values["uncertainty"]["block_hours"],
            )
        except InputError as reason:
            return str(reason)
        return ""

    def tested(self, rso: str, stations: str) -> dict[str, Experiment]:
        """The experiments of a dataset whose uncertainty is tested, by model."""
        return {learner: one for (*of, learner), one in self.calibrated.items() if of == [rso, stations]}

    @cached_property
    def fits(self) -> dict[tuple[str, str], Experiment]:
        """The experiments that the fits' own covariances are tested by, by RSO and station set."""
        return {
            (rso, stations): replace(one, learner=UNCORRECTED)
            for (rso, stations, _), one in self.calibrated.items()
        }

    @cached_property
    def windows(self) -> dict[str, str]:
        """Suffixes of the fits' windows that the models ask for, by what they say; the run's own first."""
        own = float(self.study.settings.values["estimation"]["window_hours"])
        asked = {
            float(hours)
            for name in self.learners
            if (hours := naming.parse_learner(name, self.study.learners).get("window_hours"))
        }
        return {
            f"{hours:g}-hour fits": naming.windowed(hours, default=own)
            for hours in (own, *sorted(asked - {own}))
        }

    @property
    def marks(self) -> list[float]:
        """Prediction durations that errors are stated at [days]."""
        longest = self.study.settings.values["prediction"]["max_days"]
        return [day for day in MARKS if day <= longest] or [longest]

    @cached_property
    def answer(self) -> Answer:
        """What the report tells."""
        return Answer(
            experiments=self.experiments,
            pairs=self.splits,
            trials=self.trials,
            past=self.past,
            shown=self.shown,
            stated=self.stated,
            datasets=self.datasets,
            learners={name: naming.parse_learner(name, self.study.learners) for name in self.learners},
            component=self.study.defaults["component"],
            label=self.study.label,
            truth=not all(self.study.is_measured(rso) for rso in self.study.rsos),
            rolling=list(self.rolling),
            trained_anew=self.study.rolling,
            marks=self.marks,
            without_past=self.without_past,
            settings=self.study.settings.values,
        )


def _has_past(train: str, test: str) -> bool:
    split = naming.parse_train(train)
    is_of_days = split.kind == naming.parse_test(test).kind == "days"
    return is_of_days and split.days[1] - split.days[0] >= LEAST_PAST


def _past(train: str, test: str) -> tuple[str, str]:
    """The split of the days to train on that is to them what `test` is to all of them."""
    split = naming.parse_train(train)
    first, last = split.days
    origin = round(first + PAST_SHARE * (last - first), 3)
    tried = replace(naming.parse_test(test), days=(origin, last))
    return str(replace(split, days=(first, origin))), str(tried)
