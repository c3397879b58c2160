"""A small multilayer perceptron (scikit-learn's, with Adam), its weights kept as a table."""

import warnings
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
import pandas as pd
from annotated_types import MinLen
from threadpoolctl import threadpool_limits

from opml.base.seeds import derive
from opml.base.setting_types import Count, Expected, Positive
from opml.learning.models.contract import CHOICE, Learner, Metadata, Settings, table_of
from opml.learning.models.inputs import Training, check_rows
from opml.learning.models.metadata import describe, restore
from opml.tables import count, real

KIND = "mlp"
_FIELDS = ("x_mean", "x_scale", "offset", "y_scale", "seed")
_BIAS = -1  # in column source: no neuron, the constant 1


@dataclass(frozen=True, eq=False)
class MlpModel:
    """f(x) = offset + y_scale times the output of the network, with tanh in its hidden layers."""

    variables: tuple[str, ...]
    weights: tuple[np.ndarray, ...]  # by layer, (neurons of the layer before, neurons of the layer)
    biases: tuple[np.ndarray, ...]  # by layer, (neurons,)
    x_mean: np.ndarray  # (variables,)
    x_scale: np.ndarray  # (variables,)
    offset: float
    y_scale: float
    seed: int

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predicted target (n,) in its own unit; raise InputError as `check_rows` does."""
        signal: np.ndarray = (check_rows(x, self.variables) - self.x_mean) / self.x_scale
        with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
            for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
                signal = np.tanh(signal @ weight + bias)
            signal = signal @ self.weights[-1] + self.biases[-1]
        signal = self.offset + self.y_scale * signal[:, 0]
        return signal

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return a table with one row per weight, and the model's metadata."""
        rows = []
        for layer, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            stacked = np.vstack([bias, weight])
            source, neuron = (index.ravel() for index in np.indices(stacked.shape))
            rows.append(
                {"layer": layer, "source": source + _BIAS, "neuron": neuron, "weight": stacked.ravel()}
            )
        table = pd.concat([pd.DataFrame(row) for row in rows], ignore_index=True)
        return table, describe(self, KIND, *_FIELDS)

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the model that `to_table` wrote, bit for bit."""
        weights, biases = [], []
        for _, layer in table.groupby("layer", sort=True):
            stacked = layer["weight"].to_numpy(dtype=float).reshape(-1, layer["neuron"].max() + 1)
            biases.append(stacked[0])
            weights.append(stacked[1:])
        return cls(weights=tuple(weights), biases=tuple(biases), **restore(metadata, *_FIELDS))


def fit(training: Training, settings: Settings) -> MlpModel:
    """Train a network; `settings` holds neurons (of each hidden layer), alpha and epochs.

    Raises InputError for too few rows or values that are not finite.
    """
    # Imported only to train: it takes a second, more than most models need to predict.
    from sklearn.neural_network import MLPRegressor

    training = training.validate(least=2)
    x, y = training.x, training.y
    mean, scale = training.standardisation()
    offset, y_scale = float(y.mean()), float(y.std()) or 1.0
    machine = MLPRegressor(
        hidden_layer_sizes=tuple(settings["neurons"]),
        activation="tanh",
        alpha=settings["alpha"],
        max_iter=settings["epochs"],
        random_state=int(derive(training.seed, "mlp").integers(2**31)),
    )
    with threadpool_limits(limits=1), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the number of epochs is a setting, not a failure
        machine.fit((x - mean) / scale, (y - offset) / y_scale, training.weights)
    return MlpModel(
        variables=tuple(training.variables),
        weights=tuple(machine.coefs_),
        biases=tuple(machine.intercepts_),
        x_mean=mean,
        x_scale=scale,
        offset=offset,
        y_scale=y_scale,
        seed=training.seed,
    )


LEARNER = Learner(
    kind=KIND,
    description="neural network",
    settings={
        **CHOICE,
        "neurons": Annotated[list[Count], MinLen(1), Expected("a list of whole numbers above 0")],
        "alpha": Positive,
        "epochs": Count,
    },
    table=table_of(
        "a weight",
        count("layer", "number of the layer"),
        count("source", "neuron of the layer before, -1 for the constant 1"),
        count("neuron", "neuron of the layer"),
        real("weight", "1", "weight"),
    ),
    fit=fit,
    load=MlpModel.from_table,
)
