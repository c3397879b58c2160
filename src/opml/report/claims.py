"""What a publication says in words, held against our numbers; a claim stands with the entry it is about."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from opml.naming import Experiment
from opml.report.results import Results


@dataclass(frozen=True)
class Claim:
    """A sentence, what has to hold of the numbers, and the experiments that tell them, by their label."""

    says: str
    holds: str  # a key of TESTS
    points: Mapping[str, Experiment]
    limit: float = 0.0
    share: float = 0.0
    start: float = 0.0


def judged(claim: Claim, results: Results) -> tuple[str, str, bool]:
    """Return a claim's sentence, our numbers as text, and whether it holds."""
    numbers = _numbers(claim, results)
    text = ", ".join(f"{number:.1f} ({label})" for label, number in numbers.items())
    return claim.says, text, TESTS[claim.holds](list(numbers.values()), claim)


def _numbers(claim: Claim, results: Results) -> dict[str, float]:
    """P_ML [%] of the points by their label.

    Of a claim about single points it is the share [%] whose error got smaller; of one about the longest
    predictions their mean error [km] before and after.
    """
    if claim.holds == SHARE_OF_POINTS:
        return {label: 100.0 * results.of(one)["fraction_reduced"] for label, one in claim.points.items()}
    if claim.holds == LONGEST:
        return {
            f"km {when}, {label}": results.of(one)[f"last_{when}"] / 1e3
            for label, one in claim.points.items()
            for when in ("before", "after")
        }
    return {label: results.p_ml(one) for label, one in claim.points.items()}


def _settles(numbers: Sequence[float], claim: Claim) -> bool:
    falling = all(later <= earlier for earlier, later in pairwise(numbers))
    return falling and numbers[-2] - numbers[-1] < claim.share * (numbers[0] - numbers[-1])


def _own_is_smallest(numbers: Sequence[float], claim: Claim) -> bool:
    own = [one.target == one.rso for one in claim.points.values()]
    return min(numbers) in [number for number, is_own in zip(numbers, own, strict=True) if is_own]


def _longest_fall(numbers: Sequence[float], claim: Claim) -> bool:
    before, after = numbers
    return abs(before - claim.start) < claim.share * claim.start and after < claim.limit


SHARE_OF_POINTS, LONGEST = "share_of_points_near", "mean_of_longest_falls"

TESTS: Mapping[str, Callable[[Sequence[float], Claim], bool]] = {
    "below": lambda numbers, claim: max(numbers) < claim.limit,
    "above": lambda numbers, claim: min(numbers) > claim.limit,
    "ascending": lambda numbers, claim: list(numbers) == sorted(numbers),
    "first_falls": lambda numbers, claim: numbers[1] < numbers[0],
    "last_below_share_of_first": lambda numbers, claim: numbers[-1] < claim.share * numbers[0],
    "falls_and_settles": _settles,
    "own_is_smallest": _own_is_smallest,
    LONGEST: _longest_fall,
    SHARE_OF_POINTS: lambda numbers, claim: abs(numbers[0] - claim.limit) < 100.0 * claim.share,
}
"""What may hold of the numbers [%] of a claim's points, in their order.

`share` of `falls_and_settles`: the most that the last step may be of the whole fall; of
`share_of_points_near`: the most that the share of points may be off, as a part of 1; of
`mean_of_longest_falls`, about one point: the most that the error before may be off `start`, as a part of it.
"""
