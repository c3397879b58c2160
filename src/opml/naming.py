"""The grammar of file names: every part that a product's name is made of is written and read here alone.

A station set is the stations' names joined with '-' in the sheet's order, ``eglin-kaena``. An RSO is a row's
name, or that row with another inclination in degrees (``iss_i50``), with kilometres added to its semi-major
axis (``iss_a+50``), or both (``iss_i50_a+50``). A split says which rows of a dataset a model is trained or
tested on: ``random-80``, ``grouped-80``, ``days-0-30``, ``days-30-40-unseen``, ``rest``, ``seen``. A test may
end in how its rows are treated: ``days-30-40-unfenced``, ``days-30-40-fence3``, ``rest-zscore``,
``rest-together``.

A suffix stands for one setting that differs from the run's own: ``eglin_noise43`` is what Eglin measures
under another seed, ``random-80_split43`` another draw of the same split, ``eglin_w24`` estimates from 24
hours of tracks, ``eglin_tol1`` of fits that stop earlier, ``eglin_cd0.5`` of fits that believe a drag
coefficient beforehand, ``eglin_light`` of fits that reckon with light time, ``svr_s2`` the learner ``svr``
with 2 as its kernel scale. The run's own setting has no suffix. So two names are never the same thing. What
errors are held against is ``_later`` or ``_smoothed`` estimates; no suffix is the truth.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from opml.errors import InputError

# One spelling per number, as it is part of file names: 50, 51.6393, 0.1, but neither 050 nor 0.10.
NUMBER = r"(?:0|[1-9][0-9]*)(?:\.[0-9]*[1-9])?"
POSITIVE = r"(?:0\.[0-9]*[1-9]|[1-9][0-9]*(?:\.[0-9]*[1-9])?)"

NOISE, SPLIT = "noise", "split"
"""What has a seed: the measurements, and the draw of rows and subsamples."""

WITHOUT = "-without-"

LIGHT = "_light"
"""Suffix of estimates whose fits read measurements as received after the light's travel."""

READINGS = {"kept_estimate": "_kept", "track": "_track"}
"""How a name says which earlier estimate is t_b, by the study's `cleaning.previous`."""

LABELS = {"truth": "", "later": "_later", "smoothed": "_smoothed"}
"""How a name says what the errors that are learned from are held against, by the study's `label`."""

STANDARDISATIONS = {"training": "", "own": "-zscore", "together": "-together"}
"""How a test's name says which rows' mean and deviation standardise its variables."""

SECTIONS = {
    "simulation": "2 Simulation Environment",
    "learning": "3 Prediction Accuracy Improvement through Machine Learning",
    "numerical": "4 Numerical Results of Improving Orbit Prediction",
    "future": "5 Generalize the SVM Model to Future Epochs",
    "nearby": "6 Generalization to Nearby RSOs",
    "beyond": "7 Beyond the paper",
    "study": "8 The study",
}
"""The paper's sections, numbered as it prints them, and what goes beyond it."""


@dataclass(frozen=True)
class Experiment:
    """One model applied to one test: the parts of its files' names."""

    rso: str
    stations: str
    train: str
    learner: str
    component: str
    target: str
    test: str
    reading: str = ""
    window: str = ""
    label: str = ""

    def names(self) -> dict[str, str]:
        """Return the wildcards by name."""
        return asdict(self)

    def columns(self) -> dict[str, str]:
        """Return the parts as the columns of `metrics`: window, reading and label stand with the stations."""
        names = self.names()
        names["stations"] += names.pop("window") + names.pop("reading") + names.pop("label")
        return names

    def path(self, kind: str) -> str:
        """Return the experiment's file among those of a kind, `metrics` say, below the folder of results."""
        return f"{kind}/{'/'.join(self.columns().values())}.parquet"

    @property
    def section(self) -> str:
        """The paper's section that such an experiment belongs to."""
        if self.target != self.rso:
            return SECTIONS["nearby"]
        return SECTIONS["future" if parse_test(self.test).kind == "days" else "numerical"]


def number(value: float) -> str:
    """Return the one spelling of a number from 0 in a name, to nine decimals: 50, 51.6393, 0.1."""
    return f"{value:.9f}".rstrip("0").rstrip(".")


def seeded(text: str, kind: str, seed: int, *, default: int) -> str:
    """Return the name of `text` under a seed; under the run's own seed, `default`, it is the text itself."""
    return text if seed == default else f"{text}_{kind}{seed}"


def parse_seed(text: str, kind: str, *, default: int) -> tuple[str, int]:
    """Return what a name says without its seed, and the seed."""
    base, mark, seed = text.partition(f"_{kind}")
    return base, int(seed) if mark else default


def without_seed(text: str, kind: str) -> str:
    """Return what a name says without its seed."""
    return text.partition(f"_{kind}")[0]


def seed_pattern(kind: str, *, default: int) -> str:
    """Return the regular expression of a seed's suffix, or none."""
    return rf"(?:_{kind}(?!{default}(?!\d))(?:0|[1-9]\d{{0,8}}))?"


def other_reading(previous: str) -> str:
    """Return the suffix of the reading of t_b that is not the setting's."""
    return next(suffix for setting, suffix in READINGS.items() if setting != previous)


def parse_reading(suffix: str, *, previous: str) -> str:
    """Return the `cleaning.previous` that a suffix, or none, stands for."""
    return next((setting for setting, mark in READINGS.items() if mark == suffix), previous)


def windowed(hours: float, *, default: float) -> str:
    """Return the suffix of estimates over another window [h]; none for the run's own, `default`."""
    return "" if hours == default else f"_w{number(hours)}"


def parse_window(suffix: str, *, default: float) -> float:
    """Return the hours of the estimation window that a suffix, or none, stands for; 0 of true states."""
    if suffix == PERFECT:
        return 0.0
    if suffix.startswith("_b"):
        return parse_both_sides(suffix)
    own = re.match(rf"_w({POSITIVE})", suffix)
    return float(own[1]) if own else default


def fitted(
    *, convergence: float | None = None, cd_sigma: float | None = None, light_time: bool = False
) -> str:
    """Return the suffix of fits that differ from the run's own in these settings."""
    given = {"_tol": convergence, "_cd": cd_sigma}
    marks = [mark + number(value) for mark, value in given.items() if value is not None]
    return "".join(marks) + LIGHT * light_time


def parse_fitted(suffix: str) -> dict[str, float | bool]:
    """Return the settings of the estimation that a suffix of estimates changes, beside its window."""
    found = {
        "convergence": re.search(rf"_tol({POSITIVE})", suffix),
        "cd_sigma": re.search(rf"_cd({POSITIVE})", suffix),
    }
    given = {name: float(match[1]) for name, match in found.items() if match}
    return given | ({"light_time": True} if LIGHT in suffix else {})


def fitted_pattern(*, convergence: float, light_time: bool = False) -> str:
    """Return the regular expression of what `fitted` returns in a run with these settings of its own."""
    stopping = rf"(?:_tol(?!{re.escape(number(convergence))}(?![\d.])){POSITIVE})?"
    return rf"{stopping}(?:_cd{POSITIVE})?" + ("" if light_time else f"(?:{LIGHT})?")


def both_sides(hours: float) -> str:
    """Return the suffix of estimates from tracks up to so many hours before and after each [h]."""
    return f"_b{number(hours)}"


def parse_both_sides(suffix: str) -> float:
    """Return the hours on either side that a suffix stands for; 0 of one that has none after."""
    return float(suffix.removeprefix("_b")) if suffix.startswith("_b") else 0.0


def label_window(label: str, *, hours: float) -> str:
    """Return the suffix of the estimates that a label is made of, in a run with a window of `hours`."""
    return both_sides(hours) if label == LABELS["smoothed"] else ""


def arc(hours: float, memory_days: float) -> str:
    """Return the suffix of what arcs over a window [h] know, with the memory of their Cd [days]."""
    return f"_l{number(hours)}_m{number(memory_days)}"


def parse_arc(suffix: str) -> tuple[float, float]:
    """Return window [h] and memory [days] of a suffix of arcs."""
    hours, days = suffix.removeprefix("_l").split("_m")
    return float(hours), float(days)


MEMBERS = r"[2-9]|[1-9][0-9]{1,2}"
"""Regular expression of how many futures an ensemble has."""

TRACK = r"0|[1-9][0-9]*"
"""Regular expression of the number of a track."""

ARC = f"_l{POSITIVE}_m{POSITIVE}"
"""Regular expression of the suffix of arcs."""

BOTH_SIDES = f"_b{POSITIVE}"
"""Regular expression of the suffix of estimates from tracks on both sides; nothing is predicted from them."""

PERFECT = "_true"
"""Suffix of estimates that are the truth itself."""


def window_pattern(*, default: float) -> str:
    """Return the regular expression of an estimation window's suffix, or none."""
    return rf"(?:_w(?!{re.escape(number(default))}(?![\d.])){POSITIVE})?"


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


def learner_pattern(learners: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the regular expression of a learner, its kernel scale overridden if it has one."""
    scaled = [name for name, settings in learners.items() if "kernel_scale" in settings]
    return rf"(?:{any_of(learners)}|(?:{any_of(scaled)})_s{POSITIVE})"


def parse_learner(text: str, learners: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the settings of the learner that a text names. Raises InputError for an unknown text."""
    if not re.fullmatch(learner_pattern(learners), text):
        known = ", ".join(learners)
        raise InputError(f"learner '{text}': expected one of {known}; an svr may end in _s<kernel scale>")
    name, mark, scale = text.partition("_s")
    return dict(learners[name]) | ({"kernel_scale": float(scale)} if mark else {})


def scaled(learner: str, scale: float) -> str:
    """Return the name of a learner with another kernel scale."""
    return f"{learner}_s{number(scale)}"


def pool_without(pool: str, rso: str) -> str:
    """Return the name of a pool's RSOs but one."""
    return f"{pool}{WITHOUT}{rso}"


def pool_pattern(pools: Iterable[str], sheet: Iterable[str]) -> str:
    """Return the regular expression of all RSOs of a pool but one, such as `inclinations-without-iss_i50`."""
    return rf"(?:{any_of(pools)}){WITHOUT}{rso_pattern(sheet)}"


def parse_pool(text: str, pools: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the RSOs that a pool's name stands for. Raises InputError for an unknown pool."""
    pool, _, left_out = text.partition(WITHOUT)
    if pool not in pools:
        raise InputError(f"pool '{pool}': expected one of {', '.join(pools)}")
    return [rso for rso in pools[pool] if rso != left_out]


def any_of(names: Iterable[str]) -> str:
    """Return the regular expression of some names; of none, one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"


def stations_pattern(sheet: Iterable[str]) -> str:
    """Return the regular expression of stations in any order; `parse_stations` tells the right one."""
    name = any_of(sheet)
    return f"(?:{name})(?:-(?:{name}))*"


def rso_parts(text: str, sheet: Iterable[str]) -> tuple[str, str, str]:
    """Return the base, inclination and offset that an RSO's text names, '' for what it does not vary.

    Raises InputError for a text that is not canonical or names no row of the sheet.
    """
    match = re.fullmatch(_rso(r"(?P<base>[^_]*)"), text)
    if match is None or match["base"] not in sheet:
        raise InputError(
            f"RSO '{text}': expected one of {', '.join(sheet)}, then at most _i<degrees> and _a<+ or -><km>"
        )
    return match["base"], match["i"] or "", match["a"] or ""


def rso_pattern(sheet: Iterable[str]) -> str:
    """Return the regular expression of every canonical RSO, without named groups."""
    return re.sub(r"\?P<\w+>", "?:", _rso(f"(?:{any_of(sheet)})"))


def _rso(base: str) -> str:
    return rf"{base}(?:_i(?P<i>{NUMBER}))?(?:_a(?P<a>[+-]{POSITIVE}))?"


def station_names(text: str, known: Iterable[str]) -> list[str]:
    """Return the stations that a set's canonical text names. Raises InputError for any other text."""
    known, names = list(known), text.split("-")
    if unknown := [name for name in names if name not in known]:
        raise InputError(f"stations '{text}': expected names from {', '.join(known)}, got '{unknown[0]}'")
    canonical = "-".join(name for name in known if name in names)
    if text != canonical:
        raise InputError(f"stations '{text}': expected '{canonical}', each name once in the sheet's order")
    return names


def varied_rso(base: str, inclination: str, offset: str) -> str:
    """Return the name of an RSO with another inclination [deg] and offset of its axis [km], '' for none."""
    return base + (f"_i{inclination}" if inclination else "") + (f"_a{offset}" if offset else "")
