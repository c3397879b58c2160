"""The paper's numbers and sentences under combinations of readings of what it leaves open.

Every combination is one setting for all numbers. None is chosen number by number.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import pandas as pd

from opml.naming import STANDARDISATIONS, Experiment, fence_suffix, treat_test
from opml.report.claims import Claim, judge
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.results import Results, percent

NEAR = 3.0
"""Points of P_ML within which a number counts as met."""


@dataclass(frozen=True)
class Combination:
    """One reading of each open thing: the parts of a name that it puts in place of the default ones."""

    learner: str
    window: str = ""  # suffix of the estimates
    reading: str = ""  # suffix of the dataset: which earlier estimate is t_b
    fence: float | None = None  # Tukey's, of the tested rows [IQR]; infinite for none, None for the dataset's
    standardisation: str = "training"  # rows that standardise the variables: training, own or together

    def __str__(self) -> str:
        """Return its name, unlike any other's."""
        treatment = fence_suffix(self.fence) + STANDARDISATIONS[self.standardisation]
        return f"{self.learner}{self.window}{self.reading}{treatment}"

    def of(self, experiment: Experiment) -> Experiment:
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
    """What is scanned: the combinations, the first of which is the default one, on numbers and sentences."""

    combinations: Sequence[Combination]
    numbers: Mapping[str, tuple[Experiment, float]]  # with the paper's, by name
    claims: Sequence[Claim]

    @property
    def published(self) -> dict[str, float]:
        """The paper's numbers [%] by name."""
        return {name: number for name, (_, number) in self.numbers.items()}

    @property
    def experiments(self) -> list[Experiment]:
        """Every experiment of every combination, each once."""
        asked = [own for own, _ in self.numbers.values()]
        asked += [one for claim in self.claims for one in claim.points.values()]
        return list(dict.fromkeys(found.of(one) for found in self.combinations for one in asked))


@dataclass(frozen=True)
class Outcome:
    """What a combination gives: P_ML [%] by number, and the sentences that hold of it."""

    combination: Combination
    numbers: Mapping[str, float]
    held: Sequence[bool]
    distance: float  # mean of |ours - paper's| over the numbers, in points
    near: int  # numbers within NEAR


def outcomes(scan: Scan, metrics: pd.DataFrame) -> list[Outcome]:
    """Return what each combination gives, from rows of the `metrics` table, the nearest first."""
    results = Results(metrics)
    found = [_outcome(combination, scan, results) for combination in scan.combinations]
    return sorted(found, key=lambda one: one.distance)


def _outcome(combination: Combination, scan: Scan, results: Results) -> Outcome:
    numbers = {name: results.p_ml(combination.of(own)) for name, (own, _) in scan.numbers.items()}
    off = [abs(numbers[name] - published) for name, published in scan.published.items()]
    return Outcome(
        combination,
        numbers,
        held=[judge(_under(combination, claim), results)[2] for claim in scan.claims],
        distance=sum(off) / len(off),
        near=sum(one <= NEAR for one in off),
    )


def _under(combination: Combination, claim: Claim) -> Claim:
    return replace(claim, points={label: combination.of(one) for label, one in claim.points.items()})


def document(scan: Scan, metrics: pd.DataFrame) -> list[Block]:
    """Return the whole document; `metrics`: rows of that table for all of `scan.experiments`."""
    found = outcomes(scan, metrics)
    count = len(scan.claims)
    header = ["combination", "mean distance", f"within {NEAR:g} points", "sentences", "which do not hold"]
    rows = [["the paper", "", "", "", "", *map(percent, scan.published.values())]]
    rows += [_row(one, count) for one in found]
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


def _row(one: Outcome, count: int) -> list[str]:
    missed = ", ".join(str(k) for k, held in enumerate(one.held, 1) if not held)
    cells = [f"`{one.combination}`", f"{one.distance:.1f}", str(one.near), f"{sum(one.held)} of {count}"]
    return [*cells, missed, *map(percent, one.numbers.values())]
