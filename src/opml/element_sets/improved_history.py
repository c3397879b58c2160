"""Sets as they could be improved when they were known, by the density and by what a catalogue taught."""

import hashlib
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.files import FilePath
from opml.element_sets import catalogue as catalogues
from opml.element_sets import corrector, density, features, improve, set_errors, trained_model, weighting
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.density import LearnedAir
from opml.element_sets.trained_model import CatalogueModel
from opml.element_sets.weighting import DENSITY, LEARNED
from opml.environment import known_weather, nrlmsis
from opml.environment.weather import Weather
from opml.interop.element_sets.element_set import changed
from opml.tables import read_metadata, read_table, write_table

_REACH = 80
"""Days before a morning beyond which no set tells anything of it, those of the PAST mornings reckoned."""

_KEYS = ["model", "number"]
_NUMBERS = ["number", "t", "known", "motion", "bstar", "eccentricity", "inclination"]  # that tell sets apart


class ImprovedHistory:
    """Sets of objects as they were improved on any morning: from sets and weather that were known on it."""

    def __init__(
        self,
        catalogue: ElementCatalogue,
        weather: Weather,
        trained: CatalogueModel,
        kept: FilePath | None = None,
    ) -> None:
        """Take all sets, clean weather, and what another catalogue taught.

        kept: folder of days, where the table `improved_numbers` of each morning is kept for other jobs
        """
        self._catalogue, self._weather, self._trained = catalogue, weather, trained
        self._kept, self._numbers = kept, dict[float, pd.DataFrame]()

    @classmethod
    def read(cls, paths: Sequence[FilePath], weather: FilePath) -> "ImprovedHistory":
        """Read them; weather: OBSERVED, the packaged one, or a CSSI file.

        Raises InputError for unreadable files, for weather by the month, and where pymsis is missing.
        """
        nrlmsis.check_installed()
        # As in a table `element_sets`, a set that does not say when it was made was known at its epoch, and
        # how many may be damaged is each object's own setting.
        sets = catalogues.read(paths, latency=0.0, leave_out_damaged=True)
        return cls(sets, density.clean(known_weather.read(str(weather))), trained_model.read())

    def within(self, first: float, last: float, kept: FilePath | None = None) -> "ImprovedHistory":
        """Return what mornings from one to another need of it, both modified Julian days (UTC).

        kept: as of the class
        """
        t, known = (self._catalogue.table[name] for name in ("t", "known"))
        rows = np.flatnonzero((t >= first - _REACH) & (known <= last))
        weather = self._weather.keep_known(last)
        return ImprovedHistory(self._catalogue.take(rows), weather, self._trained, kept)

    def newest(self, name: str, number: int, morning: float) -> Satrec | None:
        """Return the newest set of an object as a model improves it, None where none was known.

        name: DENSITY or LEARNED
        number: of the catalogue
        morning: modified Julian day (UTC)

        A set that cannot be improved, for the reasons of the table `improved_sets`, is as it was published;
        so are all where the weather ends too early.
        """
        table = self._catalogue.table
        known = np.flatnonzero((table["number"] == number) & (table["known"] <= morning))
        if not known.size:
            return None
        motion, bstar = self._numbers_on(morning).loc[(name, number), ["motion", "bstar"]]
        return changed(self._catalogue.satellites[known[-1]], motion, bstar)

    def _numbers_on(self, morning: float) -> pd.DataFrame:
        """Return the table `improved_numbers` by model and number.

        What is kept is made again where sets or weather that were known then came or changed, and by another
        trained model.
        """
        if morning not in self._numbers:
            path = Path(self._kept, epochs.calendar(morning), "improved.parquet") if self._kept else None
            made_of = {"morning": morning, "made_of": self._known_by(morning)}
            if path and path.exists() and made_of.items() <= read_metadata(path).items():
                kept = read_table(path, "improved_numbers")
            else:
                tables = {name: one.rename_axis("number") for name, one in self._improve(morning).items()}
                kept = pd.concat(tables, names=_KEYS).reset_index()
                if path:
                    write_table(path, kept, "improved_numbers", metadata=made_of)
            self._numbers[morning] = kept.set_index(_KEYS)
        return self._numbers[morning]

    def _known_by(self, morning: float) -> str:
        """Return the SHA-256 over all that numbers of a morning are made of."""
        table, weather = self._catalogue.table, self._weather.keep_known(morning)
        is_known = (table["t"] >= morning - _REACH) & (table["known"] <= morning)
        sets = table.loc[is_known, _NUMBERS].to_numpy(float)
        parts = [sets.tobytes(), weather.flux.tobytes(), weather.kp.tobytes(), self._trained.digest.encode()]
        return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in parts)).hexdigest()

    def _improve(self, morning: float) -> Mapping[str, pd.DataFrame]:
        """Return mean motion, B* and epoch `t` of the newest sets, by model."""
        known = self._catalogue.until(morning).daily()
        if morning - density.end_of(self._weather.keep_known(morning)) > improve.OLDEST_WEATHER:
            published = improve.newest_sets(known)[["motion", "bstar", "t"]]
            return {DENSITY: published, LEARNED: published}
        mornings = np.arange(-weighting.PAST, 1) + morning
        rows = features.build(known, set_errors.build(known, mornings), self._air)
        tried = weighting.candidates(rows, self._trained.correctors, corrector.jumps(rows))
        taught = {name: one for name, one in tried.items() if name.startswith(LEARNED)}
        today = rows["morning"] == morning
        now, corrections = rows[today], {name: one[today] for name, one in tried.items()}
        newest = improve.newest_sets(known)
        why = improve.reasons(known, newest, rows, date=morning)
        weights = {
            DENSITY: weighting.one_way(pd.Series(DENSITY, newest.index)),
            LEARNED: weighting.weights(rows, taught),
        }
        usable = {name: improve.where_usable(one, why) for name, one in weights.items()}
        return {
            name: improve.numbers(
                newest, weighting.combined(now, corrections, weighting.of_objects(one, now))
            ).assign(t=newest["t"])
            for name, one in usable.items()
        }

    @cached_property
    def _air(self) -> LearnedAir:
        first = int(np.floor(self._catalogue.table["known"].min())) - density.RUN_UP - 1
        end = density.end_of(self._weather)
        return LearnedAir(self._weather, density.measured(self._weather, first, end), self._trained.outlook)
