"""Gradient boosting of regression trees with absolute loss (scikit-learn's histogram method).

The trees are kept as a table of nodes and evaluated here, so that a saved model needs no scikit-learn.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base.seeds import derive
from opml.base.setting_types import Count, Positive
from opml.learning.models.contract import ChoosingSettings, Learner, Metadata, describe, restore, table_of
from opml.learning.models.training_inputs import Training, check_rows
from opml.tables import count, real

if TYPE_CHECKING:
    from sklearn.ensemble import HistGradientBoostingRegressor

KIND = "boosting"
_NODE = ("feature", "threshold", "left", "right", "value")


@dataclass(frozen=True, eq=False)
class BoostingModel:
    """f(x) = offset + the sum over trees of the value of the leaf that x falls into.

    The nodes of the trees stand one after the other.
    """

    variables: tuple[str, ...]
    roots: np.ndarray  # (trees,) first node of each tree
    feature: np.ndarray  # (nodes,) number of the variable compared, -1 at a leaf
    threshold: np.ndarray  # (nodes,) the next node is the left one where the variable is not above it
    left: np.ndarray  # (nodes,) number of the next node, a leaf's own number at a leaf
    right: np.ndarray  # (nodes,) likewise
    value: np.ndarray  # (nodes,) in the target's unit, 0 but at a leaf
    offset: float

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predicted target (n,) in its own unit; raise InputError as `check_rows` does."""
        # Imported only to predict: it brings Numba, which takes a second to start.
        from opml.learning.models.tree_kernels import add_leaves

        x = np.ascontiguousarray(check_rows(x, self.variables))
        predicted = np.full(len(x), self.offset, dtype=float)
        nodes = (np.ascontiguousarray(getattr(self, name)) for name in _NODE)
        add_leaves(x, self.roots, *nodes, predicted)
        return predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return a table with one row per node, and the model's metadata."""
        table = pd.DataFrame({"tree": np.searchsorted(self.roots, np.arange(len(self.value)), "right") - 1})
        for name in _NODE:
            table[name] = getattr(self, name)
        return table, describe(self, KIND, "offset")

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """Return the model that `to_table` wrote, bit for bit.

        Raises ValueError for branches that lead nowhere.
        """
        roots = np.unique(table["tree"].to_numpy(), return_index=True)[1]
        nodes = {name: table[name].to_numpy() for name in _NODE}
        _check_branches(nodes, variables=len(metadata["variables"]))
        return cls(roots=roots, **nodes, **restore(metadata, "offset"))


def _check_branches(nodes: Mapping[str, np.ndarray], *, variables: int) -> None:
    """Raise ValueError for a branch without a variable, or one that leads out of the table or backwards."""
    inner = np.flatnonzero(nodes["feature"] >= 0)
    if np.any(nodes["feature"][inner] >= variables):
        raise ValueError(f"feature: expected numbers of {variables} variables, got {nodes['feature'].max()}")
    for side in ("left", "right"):
        ahead = nodes[side][inner]
        if np.any(ahead <= inner) or np.any(ahead >= len(nodes["feature"])):
            raise ValueError(f"{side}: expected a later row of {len(nodes['feature'])}, got another")


class BoostingSettings(ChoosingSettings):
    trees: Count
    leaves: Count
    learning_rate: Positive
    min_rows: Count  # of a leaf


def fit(training: Training, settings: BoostingSettings) -> BoostingModel:
    """Train trees; raise InputError for too few rows or values that are not finite."""
    # Imported only to train: it takes a second, more than most models need to predict.
    from sklearn.ensemble import HistGradientBoostingRegressor

    training = training.validate(least=2)
    weights = training.weights
    machine = HistGradientBoostingRegressor(
        loss="absolute_error",
        max_iter=settings.trees,
        max_leaf_nodes=settings.leaves,
        learning_rate=settings.learning_rate,
        min_samples_leaf=settings.min_rows,
        early_stopping=False,
        random_state=int(derive(training.seed, "boosting").integers(2**31)),
    )
    with threadpool_limits(limits=1):  # sums in one order, whatever the machine
        machine.fit(training.x, training.y, None if weights is None else np.sqrt(weights))
    return from_machine(machine, training.variables)


def from_machine(machine: "HistGradientBoostingRegressor", variables: Sequence[str]) -> BoostingModel:
    """Return the trees of a trained machine.

    scikit-learn has no public access to them; a test compares the predictions of both.
    """
    trees = [predictor.nodes for (predictor,) in machine._predictors]
    roots = np.concatenate([[0], np.cumsum([len(tree) for tree in trees])])
    nodes, first = np.concatenate(trees), np.repeat(roots[:-1], np.diff(roots))
    leaf, itself = nodes["is_leaf"].astype(bool), np.arange(roots[-1])
    return BoostingModel(
        variables=tuple(variables),
        roots=roots[:-1],
        feature=np.where(leaf, -1, nodes["feature_idx"]),
        threshold=np.where(leaf, 0.0, nodes["num_threshold"]),
        left=np.where(leaf, itself, first + nodes["left"]),
        right=np.where(leaf, itself, first + nodes["right"]),
        value=np.where(leaf, nodes["value"], 0.0),
        offset=float(np.ravel(machine._baseline_prediction)[0]),
    )


LEARNER = Learner(
    kind=KIND,
    description="gradient boosting, absolute loss",
    settings=BoostingSettings,
    table=table_of(
        "a node of a regression tree",
        count("tree", "number of the tree"),
        count("feature", "number of the learning variable compared, -1 at a leaf"),
        real("threshold", "SI", "rows with a variable up to it go to the node `left`"),
        count("left", "row of that node; at a leaf this row"),
        count("right", "row of the node for all others; at a leaf this row"),
        real("value", "SI", "what a leaf adds to the predicted error (m or m/s)", "RSW"),
    ),
    fit=fit,
    load=BoostingModel.from_table,
)
