"""Support vector regression: scikit-learn's libsvm beside scikit-learn-intelex, both on one thread.

The same standardised rows, kernel scale, C, epsilon and tolerance; predictions also by opml's saved model.
"""

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks import case, measure
from opml.learning import metrics, splits, svr
from opml.seeds import derive

DATASET = Path(__file__).parents[1] / "results" / "dataset" / "iss" / "eglin-clear-kaena.parquet"
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


def _engines() -> dict[str, type]:
    from sklearn.svm import SVR

    engines = {"scikit-learn (libsvm)": SVR}
    try:
        import daal4py
        from sklearnex.svm import SVR as Intel
    except ImportError:
        return engines
    daal4py.daalinit(1)
    return engines | {"scikit-learn-intelex (oneDAL)": Intel}


def compare(data: Data, settings: dict) -> str:
    """Fits and predictions of e_y side by side."""
    y, true = data.y[:, 1], data.y_test[:, 1]
    model = svr.fit(data.x, y, variables=data.variables, settings=settings, seed=0)
    z, z_test = ((x - model.x_mean) / model.x_scale for x in (data.x, data.x_test))
    options = {"kernel": "rbf", "gamma": 1.0 / model.kernel_scale**2, "cache_size": svr.CACHE_MB}
    options |= {"C": settings["c"], "epsilon": settings["epsilon"], "tol": settings["tol"]}
    rows = []
    for name, engine in _engines().items():
        machine, fit = _timed(lambda engine=engine: engine(**options).fit(z, y / model.y_scale))
        found, predict = _timed(lambda machine=machine: model.y_scale * machine.predict(z_test))
        rows.append([name, fit, predict, len(machine.support_), metrics.p_ml(true, found)])
    model.predict(data.x_test[:10])
    found, predict = _timed(lambda: model.predict(data.x_test))
    rows.append(["opml's saved model", np.nan, predict, len(model.dual_coef), metrics.p_ml(true, found)])
    reference = rows[0]
    lines = [
        [
            name,
            "-" if np.isnan(fit) else f"{fit:.1f}",
            "-" if np.isnan(fit) else f"{reference[1] / fit:.1f}",
            f"{predict:.2f}",
            f"{reference[2] / predict:.1f}",
            str(vectors),
            f"{p_ml:.3f}",
        ]
        for name, fit, predict, vectors, p_ml in rows
    ]
    headings = ["engine", "fit [s]", "faster", "predict [s]", "faster", "support vectors", "P_ML [%]"]
    return f"{len(y)} rows to train, {len(true)} to test, {data.source}.\n\n" + measure.table(headings, lines)


def shared(data: Data, settings: dict) -> str:
    """What six targets on the same rows could share, and what it would save."""
    picked = np.linspace(0, len(data.x) - 1, min(SHARED_ROWS, len(data.x))).astype(int)
    x, y = data.x[picked], data.y[picked]
    model, whole = _timed(lambda: svr.fit(x, y[:, 1], variables=data.variables, settings=settings, seed=0))
    z, standardise = _timed(lambda: (x - x.mean(axis=0)) / x.std(axis=0, ddof=1))
    numbers = {key: settings[key] for key in ("epsilon", "tol")} | {"C": settings["c"]}
    scaled = [column / (np.subtract(*np.percentile(column, [75, 25])) / svr.NORMAL_IQR) for column in y.T]
    engine = _engines()["scikit-learn (libsvm)"]
    gamma = 1.0 / model.kernel_scale**2
    rows_each = [
        _timed(
            lambda column=column: engine(kernel="rbf", gamma=gamma, cache_size=svr.CACHE_MB, **numbers).fit(
                z, column
            )
        )[1]
        for column in scaled
    ]
    kernel, build = _timed(lambda: np.exp(-gamma * _squares(z)))
    precomputed = [
        _timed(lambda column=column: engine(kernel="precomputed", **numbers).fit(kernel, column))[1]
        for column in scaled
    ]
    lines = [
        ["standardisation and kernel scale", f"{standardise + whole - rows_each[1]:.2f}"],
        ["six fits, each with its own kernel rows", f"{sum(rows_each):.1f}"],
        ["one kernel matrix", f"{build:.1f}"],
        ["six fits on that matrix", f"{sum(precomputed):.1f}"],
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
