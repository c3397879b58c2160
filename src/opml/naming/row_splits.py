"""Names of training splits and tests, which choose rows of a dataset."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from opml.base.errors import InputError
from opml.naming.spelling import NUMBER, POSITIVE, number

_SHARE = rf"(random|grouped)-({NUMBER})"

_DAYS = rf"days-({NUMBER})-({NUMBER})"

_TRAIN = re.compile(f"{_SHARE}|{_DAYS}")

_FENCE = f"-(unfenced|fence{POSITIVE})"

_TEST = re.compile(f"(rest|seen)|{_DAYS}(-unseen)?(?:{_FENCE})?")

TRAIN, TEST = (re.sub(r"\((?!\?)", "(?:", split.pattern) for split in (_TRAIN, _TEST))
"""Regular expressions of a training split and a test."""


@dataclass(frozen=True)
class Split:
    """A choice of rows of a dataset: a share of rows or of estimates, a window of days, or the rest.

    A test may replace or drop the dataset's fences.
    """

    kind: str  # random, grouped, days, rest or seen
    percent: float = 100.0  # of the rows (random) or of the estimates (grouped)
    days: tuple[float, float] = (0.0, 0.0)  # window of t_j
    starts_inside: bool = False  # whether t_i lies in the window, too
    fence: float | None = None  # Tukey's, of the test's rows [IQR]; infinite: no fence, None: the dataset's

    def __str__(self) -> str:
        match self.kind:
            case "random" | "grouped":
                return f"{self.kind}-{number(self.percent)}"
            case "days":
                first, last = map(number, self.days)
                suffix = "-unseen" if self.starts_inside else ""
                if self.fence is not None:
                    suffix += "-unfenced" if math.isinf(self.fence) else f"-fence{number(self.fence)}"
                return f"days-{first}-{last}{suffix}"
        return self.kind


def parse_train(text: str) -> Split:
    """Return the training split of a name.

    Raises InputError for any other text, a percentage outside (0, 100] and days that do not ascend.
    """
    match = _TRAIN.fullmatch(text)
    if match is None:
        raise InputError(
            f"training split '{text}': expected random-<percent>, grouped-<percent> or days-<first>-<last>"
        )
    kind, percent, first, last = match.groups()
    if kind is None:
        return Split("days", days=_days(text, first, last))
    if not 0.0 < float(percent) <= 100.0:
        raise InputError(
            f"training split '{text}': expected a percentage above 0 and up to 100, got {percent}"
        )
    return Split(kind, percent=float(percent))


def parse_test(text: str) -> Split:
    """Return the test split of a name.

    Raises InputError for any other text and days that do not ascend.
    """
    match = _TEST.fullmatch(text)
    if match is None:
        raise InputError(
            f"test split '{text}': expected seen, rest, days-<first>-<last> or days-<first>-<last>-unseen"
        )
    kind, first, last, starts_inside, fence = match.groups()
    if kind is not None:
        return Split(kind)
    split = Split("days", days=_days(text, first, last), starts_inside=starts_inside is not None)
    if fence is None:
        return split
    return replace(split, fence=math.inf if fence == "unfenced" else float(fence.removeprefix("fence")))


def _days(text: str, first: str, last: str) -> tuple[float, float]:
    if float(first) >= float(last):
        raise InputError(f"split '{text}': expected the first day before the last, got {first} and {last}")
    return float(first), float(last)


def check_split(split: Split, *, duration_days: float) -> None:
    """Raise InputError where a window reaches beyond a run of `duration_days`."""
    if split.kind == "days" and split.days[1] > duration_days:
        first, last = split.days
        raise InputError(
            f"split '{split}': expected ascending days up to duration_days, {duration_days:g}, "
            f"got {first:g} and {last:g}"
        )


def days_split(days: Sequence[float]) -> str:
    """Return the name of a window of days, from days[0] to days[1]."""
    return str(Split("days", days=(float(days[0]), float(days[1]))))


def unseen_test(test: str) -> str:
    """Return the name of a test whose window holds t_i, too; a test without a window stays as it is."""
    split = parse_test(test)
    return str(replace(split, starts_inside=True)) if split.kind == "days" else test


def with_fence(test: str, fence: float | None) -> str:
    """Return the name of a test with a fence [IQR] of its own; None keeps the test's.

    Only windows of days have one: rows of a random split keep the dataset's, as its training rows do.
    """
    split = parse_test(test)
    return test if fence is None or split.kind != "days" else str(replace(split, fence=fence))
