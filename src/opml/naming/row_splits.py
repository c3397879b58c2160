"""Training splits and tests: which rows of a dataset a name chooses."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from opml.base.errors import InputError
from opml.naming.spelling import NUMBER, POSITIVE, number

STANDARDISATIONS = {"training": "", "own": "-zscore", "together": "-together"}
"""How a test's name says which rows' mean and deviation standardise its variables."""

_SHARE = rf"(random|grouped)-({NUMBER})"

_DAYS = rf"days-({NUMBER})-({NUMBER})"

_TRAIN = re.compile(f"{_SHARE}|{_DAYS}")

_FENCE = f"-(unfenced|fence{POSITIVE})"

_ROWS = f"(?:(rest|seen)|{_DAYS}(-unseen)?(?:{_FENCE})?)"

_TEST = re.compile(f"{_ROWS}({'|'.join(STANDARDISATIONS.values())})")

TRAIN, TEST, TEST_BY_ROW = (
    re.sub(r"\((?!\?)", "(?:", text) for text in (_TRAIN.pattern, _TEST.pattern, _ROWS)
)
"""Regular expressions of a training split, a test, and a test whose rows are corrected each for itself."""

TEST_TOGETHER = TEST_BY_ROW + STANDARDISATIONS["together"]
"""Regular expression of a test with a model of its own, which its rows standardise, too."""


@dataclass(frozen=True)
class Split:
    """Which rows of a dataset are chosen: a share of rows or of estimates, a window of days, the rest.

    A test may have fences of its own, or none, in place of the dataset's, and standardise by its own rows.
    """

    kind: str  # random, grouped, days, rest or seen
    percent: float = 100.0  # of the rows (random) or of the estimates (grouped)
    days: tuple[float, float] = (0.0, 0.0)  # of t_j, of a window
    unseen: bool = False  # t_i, too, lies in the window
    fence: float | None = None  # Tukey's, of its own rows [IQR]; infinite for none, None for the dataset's
    standardisation: str = "training"  # rows that standardise the variables: training, own or together

    def __str__(self) -> str:
        """Return its one name."""
        match self.kind:
            case "random" | "grouped":
                return f"{self.kind}-{number(self.percent)}"
            case "days":
                first, last = map(number, self.days)
                unseen = "-unseen" if self.unseen else ""
                return f"days-{first}-{last}{unseen}{fenced(self.fence)}{self._standardised}"
        return self.kind + self._standardised

    @property
    def _standardised(self) -> str:
        return STANDARDISATIONS[self.standardisation]


def fenced(fence: float | None) -> str:
    """Return what a test's name says of its own fences [IQR]: none where they are infinite, None has none."""
    if fence is None:
        return ""
    return "-unfenced" if math.isinf(fence) else f"-fence{number(fence)}"


def parse_train(text: str) -> Split:
    """Return the training split that a text names.

    Raises InputError for a text that names none, a percentage outside (0, 100] and days that do not ascend.
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
    """Return the test split that a text names.

    Raises InputError for a text that names none and days that do not ascend.
    """
    match = _TEST.fullmatch(text)
    if match is None:
        raise InputError(
            f"test split '{text}': expected seen, rest, days-<first>-<last> or days-<first>-<last>-unseen"
        )
    kind, first, last, unseen, fence, mark = match.groups()
    standardisation = next(name for name, own in STANDARDISATIONS.items() if own == mark)
    if kind is not None:
        return Split(kind, standardisation=standardisation)
    return Split(
        "days",
        days=_days(text, first, last),
        unseen=unseen is not None,
        fence=_fence(fence),
        standardisation=standardisation,
    )


def _fence(text: str | None) -> float | None:
    if text is None:
        return None
    return math.inf if text == "unfenced" else float(text.removeprefix("fence"))


def _days(text: str, first: str, last: str) -> tuple[float, float]:
    if float(first) >= float(last):
        raise InputError(f"split '{text}': expected the first day before the last, got {first} and {last}")
    return float(first), float(last)


def check_split(split: Split, *, duration_days: float) -> None:
    """Raise InputError where a window reaches beyond a run of so many days."""
    if split.kind == "days" and split.days[1] > duration_days:
        first, last = split.days
        raise InputError(
            f"split '{split}': expected ascending days up to duration_days, {duration_days:g}, "
            f"got {first:g} and {last:g}"
        )


def days_split(days: Sequence[float], *, unseen: bool = False) -> str:
    """Return the name of a window of days."""
    return str(Split("days", days=(float(days[0]), float(days[1])), unseen=unseen))


def as_unseen(test: str) -> str:
    """Return the window of a test with t_i in it, too; any other test is itself."""
    split = parse_test(test)
    return str(replace(split, unseen=True)) if split.kind == "days" else test


def treated(test: str, *, fence: float | None = None, standardisation: str = "training") -> str:
    """Return a test with a fence [IQR] and a standardisation of its own; None and `training` leave it as is.

    Rows of a random split keep the dataset's fences, which its training rows have, too.
    """
    split = parse_test(test)
    own = split.fence if fence is None or split.kind != "days" else fence
    standardised = split.standardisation if standardisation == "training" else standardisation
    return str(replace(split, fence=own, standardisation=standardised))
