"""What is kept of an object from morning to morning: a folder a day, whose files are written once.

kept_estimates.parquet   estimates that were made, over all windows
judged.parquet           how far ephemerides of earlier mornings were off these, model by model
paths.parquet            ephemerides of all models, for later mornings to judge
issued.parquet           the model that was flown and its sizes of errors
morning.json             what became of the object; written last
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.base.files import replacing
from opml.ephemerides.replays import arrivals
from opml.orbits.manoeuvres import Manoeuvre, are_unaware
from opml.tables import SCHEMAS, paths_schema, read_metadata, read_table, write_table

_ALONG = "e_y_"
"""How the columns of corrections begin; the name of the model follows."""


@dataclass(frozen=True)
class Paths:
    """The ephemerides of a morning; table: `paths`."""

    table: pd.DataFrame

    @property
    def made_at(self) -> float:
        """When they were made [s]."""
        return float(self.table["morning"].iloc[0])

    @property
    def start(self) -> int:
        """The track of the estimate that they start from."""
        return int(self.table["i"].iloc[0])

    def drag_after(self, duration: float) -> float:
        """Return how far a tenth more drag takes them along the track after a duration [s]."""
        return float(np.interp(duration, self.table["t_j"] - self.table["t_i"], self.table["drag_y"]))

    @property
    def models(self) -> list[str]:
        """The names of their models."""
        return [name.removeprefix(_ALONG) for name in self.table if name.startswith(_ALONG)]

    @cached_property
    def arrivals(self) -> Callable[[np.ndarray], np.ndarray]:
        """Where the prediction is at times [s], and each model's, as `replays.arrivals`; made once."""
        corrections = self.table[[f"{_ALONG}{model}" for model in self.models]].to_numpy().T
        return arrivals(self.table, corrections)


DONE = "morning.json"
"""The file of a morning that is written last."""

_TABLES = ("kept_estimates", "judged", "issued")

_PATHS = "paths"


@dataclass(frozen=True)
class Records:
    """What mornings left.

    estimates: with the window of each, `window_hours`
    judged: rows of `replay` tables, with the `model` of each
    issued: a row a morning
    paths: of mornings whose ephemerides tracks to come may reach
    """

    estimates: pd.DataFrame
    judged: pd.DataFrame
    issued: pd.DataFrame
    paths: Sequence[Paths] = ()

    @classmethod
    def empty(cls) -> Self:
        """Return the records of an object without a morning."""
        return cls(*(SCHEMAS[name].empty() for name in _TABLES))

    @classmethod
    def read(cls, folders: Sequence[Path], *, since: float, digest: str) -> Self:
        """Return the records of mornings by their folders, the newest last.

        since: of mornings after this time the ephemerides may still be judged [s]
        digest: of the settings

        Raises InputError where a table is missing or damaged, or was made with other settings.
        """
        if not folders:
            return cls.empty()
        if read_metadata(folders[-1] / "issued.parquet")["settings"] != digest:
            raise InputError(
                f"{folders[-1]}: expected mornings that were made with these settings, got others; "
                "give another folder of results, or remove these"
            )
        whole = cls(
            *(
                _below([read_table(folder / f"{name}.parquet", name) for folder in folders], name)
                for name in _TABLES
            )
        )
        recent = [folders[k] for k in whole.issued.index[whole.issued["morning"] > since]]
        return replace(whole, paths=[paths for folder in recent for paths in _paths_in(folder)])

    @property
    def burns(self) -> list[Manoeuvre]:
        """The burns that mornings found, which windows of fits begin anew behind."""
        times = self.issued["burn_t"].dropna()
        return [Manoeuvre(float(t), anew=True) for t in times]

    def estimates_over(self, hours: float) -> pd.DataFrame:
        """Return the estimates over a window [h] as they were made."""
        rows = self.estimates[self.estimates["window_hours"] == hours]
        return rows.drop(columns="window_hours").reset_index(drop=True)

    def of_window(self, hours: float, manoeuvres: Sequence[Manoeuvre] = ()) -> pd.DataFrame:
        """Return the estimates over a window [h]; a fit across a burn, found later, has not converged.

        manoeuvres: that are known, beside those that mornings found
        """
        rows = self.estimates_over(hours)
        return rows.assign(
            converged=rows["converged"] & ~self._across(rows["t"], rows["t"], hours, manoeuvres)
        )

    def rows_unaffected_by_burns(self, hours: float, manoeuvres: Sequence[Manoeuvre] = ()) -> pd.DataFrame:
        """Return the rows of `judged` whose estimates, over a window [h], know of all burns on their way.

        manoeuvres: as for `of_window`
        """
        return self.judged[~self._across(self.judged["t_i"], self.judged["t_j"], hours, manoeuvres)]

    def _across(
        self, begin: pd.Series, end: pd.Series, hours: float, manoeuvres: Sequence[Manoeuvre]
    ) -> np.ndarray:
        """Return which spans hold a burn, or begin with a fit across it that was made before it was found."""
        found, before = self.issued["burn_t"].notna(), self.issued["morning"].shift(fill_value=-np.inf)
        burns = map(Manoeuvre, self.issued.loc[found, "burn_t"], before[found])
        spans = begin.to_numpy(float), end.to_numpy(float)
        return are_unaware(*spans, [*burns, *manoeuvres], window=HOUR * hours)

    def and_then(self, more: "Records", *, since: float) -> Self:
        """Return the records with those of the next morning; since: as for `read`."""
        return replace(
            self,
            estimates=_below([self.estimates, more.estimates], "kept_estimates"),
            judged=_below([self.judged, more.judged], "judged"),
            issued=_below([self.issued, more.issued], "issued"),
            paths=[paths for paths in (*self.paths, *more.paths) if paths.made_at > since],
        )

    def write(self, folder: Path, outcome: Mapping[str, Any], *, metadata: Mapping[str, Any]) -> None:
        """Write the records of one morning into its folder, and last its outcome as JSON."""
        for name, table in zip(_TABLES, (self.estimates, self.judged, self.issued), strict=True):
            write_table(folder / f"{name}.parquet", table, name, metadata=metadata)
        for paths in self.paths:
            models, file = paths.models, folder / f"{_PATHS}.parquet"
            write_table(file, paths.table, paths_schema(models), metadata={**metadata, "models": models})
        with replacing(folder / DONE) as temporary:
            temporary.write_text(json.dumps(outcome, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _below(tables: Sequence[pd.DataFrame], name: str) -> pd.DataFrame:
    """Return tables of a schema below each other."""
    filled = [table for table in tables if len(table)]
    return pd.concat(filled, ignore_index=True) if filled else SCHEMAS[name].empty()


def _paths_in(folder: Path) -> list[Paths]:
    """Return the ephemerides that a morning left, if any."""
    file = folder / f"{_PATHS}.parquet"
    return [Paths(read_table(file, paths_schema(read_metadata(file)["models"])))] if file.exists() else []
