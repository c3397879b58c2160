"""Claims that the paper makes in words, each with a test of whether our numbers agree."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from opml.naming import Experiment
from opml.report.results import Results


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, the test that it has to pass, and the experiments that give the numbers."""

    says: str
    holds: str  # a key of TESTS
    points: Mapping[str, Experiment]  # by label
    limit: float = 0.0
    share: float = 0.0
    start: float = 0.0


def judge_claim(claim: Claim, results: Results) -> tuple[str, str, bool]:
    """Return a claim's sentence, our numbers as text, and whether the claim holds."""
    numbers = _numbers(claim, results)
    text = ", ".join(f"{number:.1f} ({label})" for label, number in numbers.items())
    return claim.says, text, TESTS[claim.holds](list(numbers.values()), claim)


def _numbers(claim: Claim, results: Results) -> dict[str, float]:
    """Return P_ML [%] of a claim's points by their label.

    A claim about single points takes the share [%] whose error got smaller instead, a claim about the longest
    predictions their mean error [km] before and after.
    """
    points = claim.points.items()
    if claim.holds == SHARE_OF_POINTS:
        return {label: 100.0 * results.row(point)["fraction_reduced"] for label, point in points}
    if claim.holds == LONGEST:
        return {
            f"km {when}, {label}": results.row(point)[f"last_{when}"] / 1e3
            for label, point in points
            for when in ("before", "after")
        }
    return {label: results.p_ml(point) for label, point in points}


def _settles(numbers: Sequence[float], claim: Claim) -> bool:
    falling = all(later <= earlier for earlier, later in pairwise(numbers))
    return falling and numbers[-2] - numbers[-1] < claim.share * (numbers[0] - numbers[-1])


def _own_is_smallest(numbers: Sequence[float], claim: Claim) -> bool:
    points = zip(numbers, claim.points.values(), strict=True)
    return min(numbers) in [number for number, point in points if point.target == point.rso]


def _longest_fall(numbers: Sequence[float], claim: Claim) -> bool:
    before, after = numbers
    return abs(before - claim.start) < claim.share * claim.start and after < claim.limit


SHARE_OF_POINTS, LONGEST = "share_of_points_near", "mean_of_longest_falls"

TESTS: Mapping[str, Callable[[Sequence[float], Claim], bool]] = {
    "below": lambda numbers, claim: max(numbers) < claim.limit,
    "above": lambda numbers, claim: min(numbers) > claim.limit,
    "ascending": lambda numbers, _: list(numbers) == sorted(numbers),
    "first_falls": lambda numbers, _: numbers[1] < numbers[0],
    "last_below_share_of_first": lambda numbers, claim: numbers[-1] < claim.share * numbers[0],
    "falls_and_settles": _settles,
    "own_is_smallest": _own_is_smallest,
    LONGEST: _longest_fall,
    SHARE_OF_POINTS: lambda numbers, claim: abs(numbers[0] - claim.limit) < 100.0 * claim.share,
}
"""Tests of the numbers [%] of a claim's points, in the points' order.

The claim's `share` is, as a part of 1,
in `falls_and_settles`: the most that the last step may be of the whole fall;
in `share_of_points_near`: the most that the share of points may be off the limit;
in `mean_of_longest_falls`, about one point: the most that the error before may be off `start`.
"""
