"""The paper's numbers and sentences under combinations of readings of what it leaves open.

Every combination is one setting for all numbers. None is chosen number by number.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import pandas as pd

from opml.naming import STANDARDISATIONS, Experiment, fence_suffix, treat_test
from opml.report.claims import Claim, judge_claim
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.results import Results, percent

NEAR = 3.0
"""Points of P_ML within which a number counts as met."""


@dataclass(frozen=True)
class Combination:
    """One reading of each open question: parts of the name of an experiment, in place of the default ones."""

    learner: str
    window: str = ""  # suffix of the estimates
    reading: str = ""  # suffix of the dataset: which earlier estimate t_b belongs to
    fence: float | None = (
        None  # Tukey's, of the test rows [IQR]; infinite for no fence, None for the dataset's
    )
    standardisation: str = "training"  # rows that standardise the variables: training, own or together

    def __str__(self) -> str:
        """Return its name, which no other combination has."""
        treatment = fence_suffix(self.fence) + STANDARDISATIONS[self.standardisation]
        return f"{self.learner}{self.window}{self.reading}{treatment}"

    def applied_to(self, experiment: Experiment) -> Experiment:
        """Return an experiment under this combination."""
        return replace(
            experiment,
            learner=self.learner,
            window=self.window,
            reading=self.reading,
            test=treat_test(experiment.test, fence=self.fence, standardisation=self.standardisation),
        )


@dataclass(frozen=True)
class Scan:
    """What is scanned.

    combinations: the default one first
    numbers: experiment and published P_ML [%], by name
    claims: the sentences
    """

    combinations: Sequence[Combination]
    numbers: Mapping[str, tuple[Experiment, float]]
    claims: Sequence[Claim]

    @property
    def published(self) -> dict[str, float]:
        """Numbers of the paper [%] by name."""
        return {name: number for name, (_, number) in self.numbers.items()}

    @property
    def experiments(self) -> list[Experiment]:
        """Every experiment of every combination, each once."""
        experiments = [experiment for experiment, _ in self.numbers.values()]
        experiments += [experiment for claim in self.claims for experiment in claim.points.values()]
        pairs = product(self.combinations, experiments)
        return list(dict.fromkeys(combination.applied_to(experiment) for combination, experiment in pairs))


@dataclass(frozen=True)
class Outcome:
    """What a combination gives."""

    combination: Combination
    numbers: Mapping[str, float]  # P_ML [%] by name
    held: Sequence[bool]  # whether each sentence holds
    distance: float  # mean of |ours - paper's| over the numbers, in points
    near: int  # numbers within NEAR


def outcomes(scan: Scan, metrics: pd.DataFrame) -> list[Outcome]:
    """Return what each combination gives, the nearest first; metrics: rows of that table."""
    results = Results(metrics)
    unsorted = [_outcome(combination, scan, results) for combination in scan.combinations]
    return sorted(unsorted, key=lambda outcome: outcome.distance)


def _outcome(combination: Combination, scan: Scan, results: Results) -> Outcome:
    numbers = {
        name: results.p_ml(combination.applied_to(experiment))
        for name, (experiment, _) in scan.numbers.items()
    }
    off = [abs(numbers[name] - published) for name, published in scan.published.items()]
    return Outcome(
        combination,
        numbers,
        held=[judge_claim(_under(combination, claim), results)[2] for claim in scan.claims],
        distance=sum(off) / len(off),
        near=sum(distance <= NEAR for distance in off),
    )


def _under(combination: Combination, claim: Claim) -> Claim:
    points = {label: combination.applied_to(experiment) for label, experiment in claim.points.items()}
    return replace(claim, points=points)


def document(scan: Scan, metrics: pd.DataFrame) -> list[Block]:
    """Return the whole document; metrics: rows of that table for all of `scan.experiments`."""
    count = len(scan.claims)
    header = ["combination", "mean distance", f"within {NEAR:g} points", "sentences", "which do not hold"]
    rows = [["the paper", "", "", "", "", *map(percent, scan.published.values())]]
    rows += [_row(outcome, count) for outcome in outcomes(scan, metrics)]
    return [
        Heading("Combinations of readings and the paper", 1),
        Paragraph(
            "P_ML [%] of each number of the paper under combinations of readings of what it leaves open, "
            "the nearest first. A combination is one setting for all numbers. The distance is the mean of "
            "|ours - paper's|. Its name is that of the learner, of the estimates, then of how tests treat "
            "their rows: `-unfenced` without Tukey's fences, `-zscore` standardised by themselves, "
            "`-together` standardised with the rows trained on."
        ),
        Table([*header, *(f"`{name}`" for name in scan.numbers)], rows),
        Heading("The sentences"),
        Table(["", "the paper"], [[str(k), claim.says] for k, claim in enumerate(scan.claims, 1)]),
    ]


def _row(outcome: Outcome, count: int) -> list[str]:
    missed = ", ".join(str(k) for k, held in enumerate(outcome.held, 1) if not held)
    held = f"{sum(outcome.held)} of {count}"
    cells = [f"`{outcome.combination}`", f"{outcome.distance:.1f}", str(outcome.near), held]
    return [*cells, missed, *map(percent, outcome.numbers.values())]
