"""Models against splits: what the paper's measure says of each, and what it says where nothing can leak.

P_ML stands with its 5th and 95th percentile over resampled estimates.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from opml import experiments, generalisation
from opml.experiments import Experiment
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.reproduction import NONE, Results
from opml.sheets import Rso

LEARNERS = {
    "none": "no correction",
    "duration_mean": "mean error by duration (Rivera & Bai 2016)",
    "repredict": "predicted again with the running mean of Cd",
    "ridge": "ridge regression",
    "svr": "SVR, as in the paper",
    "boosting": "gradient boosting, absolute loss",
    "gaussian_process": "Gaussian process",
    "mlp": "neural network",
    "mechanism": "robust linear law",
    "stacked": "robust linear law, then another learner on what it leaves",
}
"""What a kind of learner is, in words."""


def document(
    values: Mapping[str, Any],
    metrics: pd.DataFrame,
    coverage: pd.DataFrame,
    floors: Mapping[str, float],
    sheet: Mapping[str, Rso],
) -> list[Block]:
    """The whole document.

    `values`: the settings. `metrics`, `coverage`: rows of those tables for `generalisation.every` and for
    `generalisation.intervals`. `floors`: by station set, the size of the assumed model's own error [%].
    """
    results = Results(metrics)
    return [
        Heading("Does it generalise?", 1),
        Paragraph(
            "P_ML [%] is what a correction leaves of the summed absolute error: 0 is perfect, 100 no "
            "correction. In brackets its 5th and 95th percentile over resampled estimates, as the rows of "
            "one estimate are no independent evidence. `docs/generalisation.md` explains models and splits."
        ),
        *_splits(values, results),
        *_transfers(values, results, sheet),
        *_left_out(values, results),
        *_intervals(values, coverage),
        *_budget(values, results, floors),
        *_learners(values),
    ]


def _splits(values: Mapping[str, Any], results: Results) -> Iterator[Block]:
    found = generalisation.splits(values)
    entry = values["experiments"]["generalisation"]
    for stations in entry["station_sets"]:
        header, paper = ["model"], ["Peng & Bai, SVR"]
        for split, (train, test) in entry["splits"].items():
            experiment = found[stations, entry["learners"][0], split]
            estimates = results.of(experiment)["estimates"]
            header.append(f"{split}: {train}, {test} ({estimates} estimates)")
            paper.append(_number(generalisation.published(values, experiment)))
        rows = [
            [f"`{learner}`", *(_cell(results, found[stations, learner, split]) for split in entry["splits"])]
            for learner in entry["learners"]
        ]
        yield Heading(f"Models against splits: {stations}")
        yield Table(header, [paper, *rows])


def _transfers(values: Mapping[str, Any], results: Results, sheet: Mapping[str, Rso]) -> Iterator[Block]:
    entry = values["experiments"]["generalisation"]["transfers"]
    found = generalisation.transfers(values, sheet)
    for curve in values["experiments"]["curves"]:
        rows = []
        for target in experiments.targets(values, curve, sheet):
            own = [found[curve, learner, target] for learner in entry["learners"]]
            paper = _number(generalisation.published(values, own[0]))
            rows.append([f"`{target}`", paper, *(_cell(results, one) for one in own)])
        yield Heading(f"Trained on one RSO, applied to others: {curve.replace('_', ' ')}")
        yield Paragraph(f"Trained on {entry['train']} of {own[0].rso}, tested on {entry['test']} of each.")
        yield Table(["RSO", "Peng & Bai", *(f"`{learner}`" for learner in entry["learners"])], rows)


def _left_out(values: Mapping[str, Any], results: Results) -> Iterator[Block]:
    entry = values["experiments"]["generalisation"]["transfers"]
    found = generalisation.left_out(values)
    rows = [
        [pool, f"`{rso}`", *(_cell(results, found[pool, learner, rso]) for learner in entry["learners"])]
        for pool, rsos in values["pools"].items()
        for rso in rsos
    ]
    yield Heading("One RSO left out")
    yield Paragraph(
        f"Trained on {entry['train']} of all other RSOs of a pool, tested on {entry['test']} of the one that "
        "was left out."
    )
    yield Table(["pool", "left out", *(f"`{learner}`" for learner in entry["learners"])], rows)


def _intervals(values: Mapping[str, Any], coverage: pd.DataFrame) -> Iterator[Block]:
    name = {tuple(pair): split for split, pair in values["experiments"]["generalisation"]["splits"].items()}
    rows = [
        [
            one["stations"],
            f"`{one['learner']}`",
            name[one["train"], one["test"]],
            _number(100.0 * one["rows_inside"]),
            _number(100.0 * one["estimates_inside"]),
            *(
                f"{1e-3 * one[length]:.2f}"
                for length in ("half_width", "half_width_last_day", "error_last_day")
            ),
        ]
        for one in coverage.to_dict("records")
    ]
    yield Heading("Prediction intervals")
    yield Paragraph(
        f"Split-conformal by estimate at {values['intervals']['level']:.0%}: what share of the rows lies "
        "inside, and its mean over estimates, which is what the level promises while estimates are alike. "
        "Lengths are medians in km (km/s for a velocity); the last day is that of the longest predictions."
    )
    header = ["stations", "model", "split", "rows inside [%]", "by estimate [%]", "half width"]
    yield Table([*header, "half width, last day", "error, last day"], rows)


def _budget(values: Mapping[str, Any], results: Results, floors: Mapping[str, float]) -> Iterator[Block]:
    entry = values["experiments"]["generalisation"]
    found = generalisation.budget(values)
    rows = [
        [
            stations,
            *(_cell(results, found[stations, learner]) for learner in entry["budget"]["learners"]),
            _number(floors[stations]),
        ]
        for stations in entry["station_sets"]
    ]
    yield Heading("What the error is made of")
    yield Paragraph(
        "P_ML on "
        + ", ".join(entry["budget"]["split"])
        + " of laws that know more and more. Those that know an "
        "estimate's true error of semi-major axis (`drift`) or the assumed model's own (`floor`) are no "
        "correctors, as they need the truth. The last column is the size of the assumed model's own error, "
        "from the true state and Cd, in % of the whole: what no estimate, however good, goes below."
    )
    header = [f"`{one}`: {' '.join(_terms(values, one))}" for one in entry["budget"]["learners"]]
    yield Table(["stations", *header, "assumed model's own error [%]"], rows)


def _learners(values: Mapping[str, Any]) -> Iterator[Block]:
    rows = []
    for name in values["experiments"]["generalisation"]["learners"]:
        settings = values["learners"][name.partition("_s")[0]]
        rows.append([f"`{name}`", LEARNERS[settings["kind"]], " ".join(_terms(values, name)) or NONE])
    yield Heading("The models")
    yield Table(["model", "is", "terms"], rows)


def _terms(values: Mapping[str, Any], learner: str) -> Sequence[str]:
    return [f"`{term}`" for term in values["learners"].get(learner, {}).get("terms", [])]


def _cell(results: Results, experiment: Experiment) -> str:
    row = results.of(experiment)
    return f"{row['p_ml']:.1f} ({row['p_ml_low']:.1f} to {row['p_ml_high']:.1f})"


def _number(value: float | None) -> str:
    return NONE if value is None else f"{value:.1f}"
