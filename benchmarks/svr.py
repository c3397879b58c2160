"""Support vector regression: scikit-learn's libsvm beside scikit-learn-intelex.

The same standardised rows, kernel scale, C, epsilon and tolerance; predictions also by opml's saved model.
"""

import importlib.util
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks import case, measure
from opml.learning import kernel_scale, metrics, splits, svr
from opml.learning.inputs import standardisation
from opml.seeds import derive

DATASET = Path(__file__).parents[1] / "results" / "dataset" / "iss" / "eglin-clear-kaena.parquet"
ROUNDS = 3
OURS = "opml's saved model"
TARGETS = ["e_x", "e_y", "e_z", "e_vx", "e_vy", "e_vz"]
SHARED_ROWS = 6000
"""Rows on which one kernel matrix for all targets is tried: 290 MB of it."""


@dataclass(frozen=True)
class Data:
    """Rows to train and to test on: variables x (n, variables) and the six errors y (n, 6)."""

    source: str
    variables: list[str]
    x: np.ndarray
    y: np.ndarray
    x_test: np.ndarray
    y_test: np.ndarray


def read(path: Path) -> Data:
    """The rows of the paper's split 80 to 20, of a dataset of the workflow or, without one, made up."""
    values = case.paper().values
    if not path.exists():
        return _made_up()
    dataset, variables = pd.read_parquet(path), values["learning"]["variables"]
    span, seed = values["learning"]["span_days"], values["seed"]["split"]
    train = splits.training_rows(dataset, "random-80", span_days=span, seed=seed)
    test = dataset["keep"].to_numpy() & splits.in_days(dataset["t_j"].to_numpy(), span) & ~train
    x, y = dataset[variables].to_numpy(), dataset[TARGETS].to_numpy()
    return Data("the three-station dataset", variables, x[train], y[train], x[test], y[test])


def _made_up(rows: int = 20_000, count: int = 24) -> Data:
    """Rows that resemble the dataset: errors that grow with the square of one variable, with heavy tails."""
    rng = derive(case.paper().values["seed"]["split"], "benchmarks", "svr")
    x = rng.normal(size=(rows, count))
    growth = (2.0 + x[:, :1]) ** 2 * x[:, 1:2]
    y = growth * rng.uniform(0.5, 2.0, 6) + 0.05 * rng.standard_t(3, size=(rows, 6))
    cut = rows * 4 // 5
    names = [f"v{k}" for k in range(count)]
    return Data(
        "made-up rows, as no dataset of the workflow is at hand", names, x[:cut], y[:cut], x[cut:], y[cut:]
    )


def _timed(call: Callable[[], object]) -> tuple[object, float]:
    begin = time.perf_counter()
    found = call()
    return found, time.perf_counter() - begin


def _engines() -> dict[str, tuple[type, int]]:
    """Classes with scikit-learn's face, and the threads they may use."""
    from sklearn.svm import SVR

    engines = {"scikit-learn (libsvm)": (SVR, 1)}
    if importlib.util.find_spec("sklearnex"):
        from sklearnex.svm import SVR as Intel

        engines["scikit-learn-intelex (oneDAL), one thread"] = (Intel, 1)
        engines["scikit-learn-intelex (oneDAL), all cores"] = (Intel, os.cpu_count())
    return engines


def _on(threads: int) -> None:
    """Let oneDAL use that many threads; libsvm only ever uses one."""
    if importlib.util.find_spec("daal4py"):
        import daal4py

        daal4py.daalinit(threads)


def compare(data: Data, settings: dict) -> str:
    """Fits and predictions of e_y side by side, in turns."""
    y, true = data.y[:, 1], data.y_test[:, 1]
    model = svr.fit(data.x, y, variables=data.variables, settings=settings, seed=0)
    z, z_test = ((x - model.x_mean) / model.x_scale for x in (data.x, data.x_test))
    options = {"kernel": "rbf", "gamma": 1.0 / model.kernel_scale**2, "cache_size": svr.CACHE_MB}
    options |= {"C": settings["c"], "epsilon": settings["epsilon"], "tol": settings["tol"]}
    engines = _engines()
    seconds = {name: [] for name in [*engines, OURS]}
    answers = {}
    for _ in range(ROUNDS):
        for name, (engine, threads) in engines.items():
            _on(threads)
            machine, fit = _timed(lambda engine=engine: engine(**options).fit(z, y / model.y_scale))
            found, predict = _timed(lambda machine=machine: model.y_scale * machine.predict(z_test))
            seconds[name].append((fit, predict))
            answers[name] = len(machine.support_), metrics.p_ml(true, found)
        found, predict = _timed(lambda: model.predict(data.x_test))
        seconds[OURS].append((np.nan, predict))
        answers[OURS] = len(model.dual_coef), metrics.p_ml(true, found)
    fits, predictions = (
        {name: [pair[k] for pair in pairs] for name, pairs in seconds.items()} for k in range(2)
    )
    first = next(iter(engines))
    lines = [
        [
            name,
            *_beside(fits[first], fits[name]),
            *_beside(predictions[first], predictions[name]),
            str(vectors),
            f"{p_ml:.3f}",
        ]
        for name, (vectors, p_ml) in answers.items()
    ]
    headings = ["engine", "fit [s]", "faster", "predict [s]", "faster", "support vectors", "P_ML [%]"]
    return f"{len(y)} rows to train, {len(true)} to test, {data.source}.\n\n" + measure.table(headings, lines)


def _beside(reference, found):
    """Median time, and how much faster than the reference."""
    if np.isnan(found).all():
        return "-", "-"
    return f"{np.median(found):.2f}", f"{measure.paired_ratio(reference, found):.1f}"


def shared(data: Data, settings: dict) -> str:
    """What six targets on the same rows could share, and what it would save."""
    picked = np.linspace(0, len(data.x) - 1, min(SHARED_ROWS, len(data.x))).astype(int)
    x, y = data.x[picked], data.y[picked]
    (mean, deviation), standardise = _timed(lambda: standardisation(x))
    z = (x - mean) / deviation
    rng = derive(0, "benchmarks", "svr")
    scale, choose = _timed(lambda: kernel_scale.distance_quantile(z, 0.1, rng=rng))
    gamma, engine = 1.0 / scale**2, next(iter(_engines().values()))[0]
    options = {"C": settings["c"], "epsilon": settings["epsilon"], "tol": settings["tol"]}
    options["cache_size"] = svr.CACHE_MB
    targets = [column * svr.NORMAL_IQR / np.subtract(*np.percentile(column, [75, 25])) for column in y.T]

    def fit_all(rows, **kind):
        return _timed(lambda: [engine(**kind, **options).fit(rows, target) for target in targets])[1]

    apart = fit_all(z, kernel="rbf", gamma=gamma)
    kernel, build = _timed(lambda: np.exp(-gamma * _squares(z)))
    lines = [
        ["standardisation and kernel scale, once", f"{standardise + choose:.2f}"],
        ["six fits, each with its own kernel rows", f"{apart:.1f}"],
        ["one kernel matrix", f"{build:.1f}"],
        ["six fits on that matrix", f"{fit_all(kernel, kernel='precomputed'):.1f}"],
    ]
    return measure.table([f"six targets on {len(x)} rows", "seconds"], lines)


def _squares(z):
    norms = np.sum(z**2, axis=1)
    return np.maximum(norms[:, None] + norms - 2.0 * z @ z.T, 0.0)


def report(path: Path = DATASET) -> str:
    """Both tables, in Markdown."""
    data, settings = read(path), case.paper().values["learners"]["svr"]
    return compare(data, settings) + "\n" + shared(data, settings)


if __name__ == "__main__":
    print(report(Path(sys.argv[1]) if len(sys.argv) > 1 else DATASET))
