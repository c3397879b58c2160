"""A trained model in a file: the forecast of the density and the correctors of its populations.

The file is a table of the trees' nodes; its metadata holds the rest and the card: what it was trained on,
and how it was judged.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.provenance import contents_digest
from opml.element_sets.corrector import BandModels, Corrector
from opml.element_sets.density import DAYS_AHEAD, HEIGHTS
from opml.element_sets.features import FEATURES
from opml.learning.models.boosting import BoostingModel
from opml.tables import read_metadata, read_table, write_table

SUFFIX = ".parquet"  # of a model's file

PACKAGED = "corrector.parquet"  # file of the model that comes with the package, in its folder of data

_QUANTITIES = ("miss", "size")
_NODE = ("feature", "threshold", "left", "right", "value")


@dataclass(frozen=True, eq=False)
class CatalogueModel:
    """A corrector trained on a catalogue."""

    outlook: np.ndarray  # coefficients of the forecast of the density, as of `density.fit`
    correctors: Mapping[str, Corrector]  # by the name of the population
    card: Mapping[str, Any]  # what it was trained on, JSON values
    digest: str = ""  # of the file that it was read from


def write(path: FilePath, model: CatalogueModel) -> None:
    """Write a model of trees, whole or not at all."""
    tables: list[pd.DataFrame] = []
    parts: list[dict[str, Any]] = []
    for name, corrector in sorted(model.correctors.items()):
        for part in corrector:
            trees = {"miss": part.miss, "size": part.size}
            for quantity, one in trees.items():
                assert isinstance(one, BoostingModel)
                table, metadata = one.to_table()
                tables.append(table.assign(part=len(parts), quantity=quantity))
                trees[quantity] = metadata["offset"]
            shares = [[*key, share] for key, share in sorted(part.shares.items())]
            parts.append(
                {"population": name, "bands": part.bands, "leads": part.leads, "shares": shares, **trees}
            )
    metadata = {
        "card": dict(model.card),
        "features": list(FEATURES),
        "outlook": model.outlook.tolist(),
        "parts": parts,
    }
    write_table(path, pd.concat(tables, ignore_index=True), "corrector", metadata=metadata)


def read(path: FilePath | None = None) -> CatalogueModel:
    """Read a model; None: the one that comes with the package.

    Raises InputError for a file that is none, or of other features than this version's.
    """
    if path is None:
        with resources.as_file(resources.files("opml") / "data" / PACKAGED) as packaged:
            return read(packaged)
    table, metadata = read_table(path, "corrector"), read_metadata(path)
    if metadata.get("features") != list(FEATURES):
        raise InputError(f"{path}: expected a model of this version's features, got another: train it again")
    outlook = np.array(metadata["outlook"])
    if outlook.shape[::2] != (DAYS_AHEAD, len(HEIGHTS)):
        raise InputError(f"{path}: expected an outlook of {DAYS_AHEAD} days, got an array {outlook.shape}")
    nodes = dict(list(table.groupby(["part", "quantity"])))
    correctors: dict[str, Corrector] = {}
    for k, part in enumerate(metadata["parts"]):
        miss, size = (
            BoostingModel.from_table(
                nodes[k, quantity].drop(columns=["part", "quantity"]).reset_index(drop=True),
                {"variables": list(FEATURES), "offset": part[quantity]},
            )
            for quantity in _QUANTITIES
        )
        shares = {(band, lead): share for band, lead, share in part["shares"]}
        own = BandModels(tuple(part["bands"]), tuple(part["leads"]), miss, size, shares)
        correctors[part["population"]] = (*correctors.get(part["population"], ()), own)
    return CatalogueModel(outlook, correctors, metadata["card"], contents_digest([Path(path)]))


def packaged_card() -> Mapping[str, Any]:
    """Return the card of the model that comes with the package."""
    with resources.as_file(resources.files("opml") / "data" / PACKAGED) as packaged:
        return dict(read_metadata(packaged)["card"])


def hindsight(card: Mapping[str, Any], date: str) -> str:
    """Return a warning where a model was trained on what came after a date (UTC text), else ''."""
    days = [population["to"] for population in card["populations"].values()]
    last = max([*days, card["weather_to"]])
    day = date[: len(last)]
    return f"the model was trained on data up to {last}, later than {day}" if day <= last else ""
