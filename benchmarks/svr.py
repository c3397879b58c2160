"""Support vector regression: opml's solver beside scikit-learn's libsvm and scikit-learn-intelex.

The same standardised rows, kernel scale, C, epsilon and tolerance; processor time of one thread.
"""

import importlib.util
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from benchmarks import case, measure
from opml.base.seeds import derive
from opml.learning.data import splits
from opml.learning.judge import metrics
from opml.learning.models import gaussian_kernel, svr
from opml.learning.models.training_inputs import Training, standardisation

DATASET = Path(__file__).parents[1] / "results" / "dataset" / "iss" / "eglin-clear-kaena.parquet"
ROUNDS = 3
OURS = "opml"
SPAN_DAYS = (0.0, 30.0)
"""The paper's, of config/studies/paper.yaml."""
CACHE_MB = 500.0
"""Of kernel rows, for libsvm: more saves no time at 25 000 rows."""
TARGETS = ["e_x", "e_y", "e_z", "e_vx", "e_vy", "e_vz"]
SHARED_ROWS = 6000
"""Rows on which one kernel matrix for all targets is tried: 144 MB of it in single precision."""


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
    """Return the rows of the paper's split 80 to 20, of a dataset of the workflow, or made up."""
    values = case.paper().values
    if not path.exists():
        return _made_up()
    dataset, variables = pd.read_parquet(path), values["learning"]["variables"]
    train = splits.training_rows(dataset, "random-80", span_days=SPAN_DAYS, seed=values["seed"]["split"])
    test = splits.test_rows(dataset, "rest", span_days=SPAN_DAYS, trained=train)
    x, y = dataset[variables].to_numpy(), dataset[TARGETS].to_numpy()
    return Data("the three-station dataset", variables, x[train], y[train], x[test], y[test])


def _made_up(rows: int = 20_000, count: int = 24) -> Data:
    """Make up rows like the dataset's: heavy-tailed errors that grow with the square of one variable."""
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
    begin = time.process_time()
    with threadpool_limits(1):
        found = call()
    return found, time.process_time() - begin


def _engines() -> dict[str, type]:
    """Return the classes with scikit-learn's face."""
    from sklearn.svm import SVR

    engines = {"scikit-learn (libsvm)": SVR}
    if importlib.util.find_spec("sklearnex"):
        import daal4py
        from sklearnex.svm import SVR as Intel

        daal4py.daalinit(1)
        engines["scikit-learn-intelex (oneDAL)"] = Intel
    return engines


def compare(data: Data, settings: dict) -> str:
    """Time fits and predictions of e_y side by side, in turns."""
    y, true = data.y[:, 1], data.y_test[:, 1]
    model = _fit(data, y, settings)
    settings = settings | {"kernel_scale": model.kernel_scale}
    z, z_test = ((x - model.x_mean) / model.x_scale for x in (data.x, data.x_test))
    options = {"kernel": "rbf", "gamma": 1.0 / model.kernel_scale**2, "cache_size": CACHE_MB}
    options |= {"C": settings["c"], "epsilon": settings["epsilon"], "tol": settings["tol"]}
    engines = _engines()
    seconds = {name: [] for name in [*engines, OURS]}
    answers = {}
    for _ in range(ROUNDS):
        for name, engine in engines.items():
            machine, fit = _timed(lambda engine=engine: engine(**options).fit(z, y / model.y_scale))
            found, predict = _timed(lambda machine=machine: model.y_scale * machine.predict(z_test))
            seconds[name].append((fit, predict))
            answers[name] = len(machine.support_), metrics.p_ml(true, found)
        _, fit = _timed(lambda: _fit(data, y, settings))
        found, predict = _timed(lambda: model.predict(data.x_test))
        seconds[OURS].append((fit, predict))
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


def _fit(data: Data, y: np.ndarray, settings: dict) -> svr.SvrModel:
    checked = svr.SvrSettings.model_validate({"kind": "svr", **settings})
    return svr.fit(Training(data.x, y, data.variables, seed=0), checked)


def _beside(reference, found):
    """Return the median time, and how much faster it is than the reference."""
    return f"{np.median(found):.2f}", f"{measure.paired_ratio(reference, found):.1f}"


def shared(data: Data, settings: dict) -> str:
    """Return what six targets on the same rows could share, and what it would save."""
    picked = np.linspace(0, len(data.x) - 1, min(SHARED_ROWS, len(data.x))).astype(int)
    rows = replace(data, x=data.x[picked], y=data.y[picked])
    (mean, deviation), standardise = _timed(lambda: standardisation(rows.x))
    z = (rows.x - mean) / deviation
    rng = derive(0, "benchmarks", "svr")
    scale, choose = _timed(lambda: gaussian_kernel.distance_quantile(z, 0.1, rng=rng))
    _, apart = _timed(lambda: [_fit(rows, y, settings | {"kernel_scale": scale}) for y in rows.y.T])
    _, build = _timed(lambda: np.exp(_exponents(z / scale), dtype=np.float32))
    lines = [
        ["standardisation and kernel scale, once", f"{standardise + choose:.2f}"],
        ["six fits, each with its own kernel rows", f"{apart:.1f}"],
        ["one kernel matrix, before any fit", f"{build:.1f}"],
    ]
    return measure.table([f"six targets on {len(z)} rows", "seconds"], lines)


def _exponents(z):
    norms = np.sum(z**2, axis=1)
    return (np.minimum(2.0 * z @ z.T - norms[:, None] - norms, 0.0)).astype(np.float32)


def report(path: Path = DATASET) -> str:
    """Return both tables, in Markdown."""
    data, settings = read(path), case.paper().values["learners"]["svr"]
    return compare(data, settings) + "\n" + shared(data, settings)


if __name__ == "__main__":
    print(report(Path(sys.argv[1]) if len(sys.argv) > 1 else DATASET))
