"""Gradient boosting of regression trees with absolute loss (scikit-learn's histogram method).

The trees are kept as tables of nodes and predicted from here, so that a saved model needs no scikit-learn.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base.seeds import derive
from opml.base.setting_types import Count, Positive
from opml.learning.models.contract import CHOICE, Learner, Metadata, Settings, table_of
from opml.learning.models.inputs import checked, checked_target
from opml.tables import count, real

if TYPE_CHECKING:
    from sklearn.ensemble import HistGradientBoostingRegressor

_NODE = ("feature", "threshold", "left", "right", "value")


@dataclass(frozen=True, eq=False)
class BoostingModel:
    """f(x) = offset + the sum over trees of the value of the leaf that x falls into.

    The trees' nodes stand one after the other; `roots` are the trees' first ones.
    """

    variables: tuple[str, ...]
    roots: np.ndarray  # (trees,)
    feature: np.ndarray  # (nodes,) variable asked, -1 at a leaf
    threshold: np.ndarray  # (nodes,) left where the variable is not above it
    left: np.ndarray  # (nodes,) the node to go to, its own at a leaf
    right: np.ndarray  # (nodes,)
    value: np.ndarray  # (nodes,) in the target's unit, 0 but at a leaf
    offset: float

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Predicted target (n,) in its own unit; raises InputError as `checked` does."""
        x = checked(x, self.variables)
        rows = np.arange(len(x))
        predicted = np.full(len(x), self.offset)
        for root in self.roots:
            node = np.full(len(x), root)
            while np.any(self.feature[node] >= 0):
                below = x[rows, self.feature[node]] <= self.threshold[node]
                node = np.where(below, self.left[node], self.right[node])
            predicted += self.value[node]
        return predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """One row per node, and metadata of JSON-able values."""
        table = pd.DataFrame({"tree": np.searchsorted(self.roots, np.arange(len(self.value)), "right") - 1})
        for name in _NODE:
            table[name] = getattr(self, name)
        return table, {"kind": "boosting", "variables": list(self.variables), "offset": self.offset}

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The model that `to_table` wrote, bit for bit; raises ValueError for branches that lead nowhere."""
        roots = np.unique(table["tree"].to_numpy(), return_index=True)[1]
        nodes = {name: table[name].to_numpy() for name in _NODE}
        _check_branches(nodes, variables=len(metadata["variables"]))
        return cls(tuple(metadata["variables"]), roots, **nodes, offset=metadata["offset"])


def _check_branches(nodes: Mapping[str, np.ndarray], *, variables: int) -> None:
    """ValueError where a branch asks for no variable, or could lead out of the table or round in circles."""
    inner = np.flatnonzero(nodes["feature"] >= 0)
    if np.any(nodes["feature"][inner] >= variables):
        raise ValueError(f"feature: expected numbers of {variables} variables, got {nodes['feature'].max()}")
    for side in ("left", "right"):
        ahead = nodes[side][inner]
        if np.any(ahead <= inner) or np.any(ahead >= len(nodes["feature"])):
            raise ValueError(f"{side}: expected a later row of {len(nodes['feature'])}, got another")


def fit(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Settings,
    seed: int,
    groups: np.ndarray | None = None,
    weights: np.ndarray | None = None,
) -> BoostingModel:
    """Train on rows x (n, variables) and target y (n,), both in their own units.

    `settings` holds trees, leaves, learning_rate and min_rows, the least rows of a leaf. Raises InputError
    for too few rows or values that are not finite.
    """
    # Imported only to train: it takes a second, more than most models need to predict.
    from sklearn.ensemble import HistGradientBoostingRegressor

    x = checked(x, variables)
    y = checked_target(y, len(x), least=2)
    machine = HistGradientBoostingRegressor(
        loss="absolute_error",
        max_iter=settings["trees"],
        max_leaf_nodes=settings["leaves"],
        learning_rate=settings["learning_rate"],
        min_samples_leaf=settings["min_rows"],
        early_stopping=False,
        random_state=int(derive(seed, "boosting").integers(2**31)),
    )
    with threadpool_limits(limits=1):  # sums in one order, whatever the machine
        machine.fit(x, y, None if weights is None else np.sqrt(weights))
    return _model(machine, variables)


def _model(machine: "HistGradientBoostingRegressor", variables: Sequence[str]) -> BoostingModel:
    """The trees of a trained machine: scikit-learn has no public way to them, a test compares with it."""
    trees = [predictor.nodes for (predictor,) in machine._predictors]
    roots = np.concatenate([[0], np.cumsum([len(tree) for tree in trees])])
    nodes, first = np.concatenate(trees), np.repeat(roots[:-1], np.diff(roots))
    leaf, own = nodes["is_leaf"].astype(bool), np.arange(roots[-1])
    return BoostingModel(
        variables=tuple(variables),
        roots=roots[:-1],
        feature=np.where(leaf, -1, nodes["feature_idx"]),
        threshold=np.where(leaf, 0.0, nodes["num_threshold"]),
        left=np.where(leaf, own, first + nodes["left"]),
        right=np.where(leaf, own, first + nodes["right"]),
        value=np.where(leaf, nodes["value"], 0.0),
        offset=float(np.ravel(machine._baseline_prediction)[0]),
    )


LEARNER = Learner(
    kind="boosting",
    description="gradient boosting, absolute loss",
    settings={
        **CHOICE,
        "trees": Count,
        "leaves": Count,
        "learning_rate": Positive,
        "min_rows": Count,
    },
    table=table_of(
        "a node of a regression tree",
        count("tree", "number of the tree"),
        count("feature", "number of the learning variable asked, -1 at a leaf"),
        real("threshold", "SI", "the branch is the left one where the variable is not above it"),
        count("left", "row of the left node, its own at a leaf"),
        count("right", "row of the right node, its own at a leaf"),
        real("value", "SI", "what a leaf adds to the predicted error (m or m/s)", "RSW"),
    ),
    fit=fit,
    load=BoostingModel.from_table,
)
