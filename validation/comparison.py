"""The whole comparison: both sides, the report and the tables that tests read."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pandas as pd

from opml.base.constants import HOUR
from opml.dynamics.kernels.surroundings import ForceModel
from opml.environment import nodes
from validation import estimation, ours, report, shadow, steps, tables, terms, trajectories
from validation.case import OURS_CONVERGED, REPORT, Case
from validation.orekit import Data, Orekit, version
from validation.workers import Workers

if TYPE_CHECKING:
    from concurrent.futures import Future

_EVERY = slice(None, None, 8)
"""Which of the random times shadows are looked for from, and tests read."""

_PENUMBRAS = 2
"""Penumbras of each RSO that tests read."""


def run(case: Case, data: Data, *, progress: Callable[[str], None]) -> None:
    """Compare, then write docs/tables/orekit.md and tests/reference/validation_*.csv."""
    progress("Same environment for both sides")
    orekit = Orekit(case.epoch)
    t = nodes(case.epoch, case.duration)
    environment = ours.from_orekit(orekit, data, epoch=case.epoch, t=t, degree=case.degree)
    models = {name: environment.model(settings) for name, settings in case.models.items()}
    kernel = data.path("ephemerides").name
    source = (
        f"Orekit {version()}; EIGEN-6S frozen at {case.epoch} UTC; {kernel}; t [s] since that epoch; SI units"
    )
    field = f"{source}; GM {environment.gm!r}, radius {environment.radius!r}"
    tables.write("gravity", tables.gravity(orekit, case.degree), field)
    tables.write("bodies", tables.bodies(environment.gms), source)
    with Workers(data, case.epoch, progress=progress) as workers:
        awaited = trajectories.orekits(workers, case, environment.gm)
        both = _Both(case, orekit, environment, models, workers, progress)
        results = report.Results(
            **both.terms(source),
            **both.light(source),
            **both.orbits(),
            **both.steps(),
            **both.fits(source),
            **both.orekits_orbits(awaited, source),
        )
    text = report.markdown(case, results, orekit=version(), kernel=kernel)
    REPORT.write_text(text, encoding="utf-8")
    progress(f"Wrote {REPORT}")


@dataclass(frozen=True)
class _Both:
    """Both sides of the comparison, and its parts."""

    case: Case
    orekit: Orekit
    environment: ours.Environment
    models: Mapping[str, ForceModel]
    workers: Workers
    progress: Callable[[str], None]

    def terms(self, source: str) -> dict:
        """Compare forces, rotation and measurements at random states."""
        self.progress("Forces, rotation and measurements at random states")
        case, gm = self.case, self.environment.gm
        t = case.random_times(terms.TIMES)
        states = terms.states(case, self.models["truth"], t)
        theirs = terms.orekits(self.orekit, case, states, gm)
        places = theirs[terms.ITRF].to_numpy()
        mine = terms.opmls(self.models, case.rsos, case.stations, states, places)
        kept = states["t"].isin(t[_EVERY])
        tables.write("terms", pd.concat([states, theirs], axis=1)[kept], source, "GCRF; gravity in ITRF")
        tables.write("nodes", tables.nodes(self.environment, t[_EVERY]), source, "GCRF")
        return {"places": places, "differences": terms.differences(case, theirs, mine)}

    def light(self, source: str) -> dict:
        """Compare edges of the shadow and the light between them."""
        self.progress("Edges of the shadow")
        starts = self.case.random_times(terms.TIMES)[_EVERY]
        edges, light = shadow.crossings(self.orekit, self.case, self.models["truth"], starts)
        kept = light.groupby("rso", sort=False).head(_PENUMBRAS * shadow.SAMPLES)
        kept = kept.drop(columns="lit_ours").rename(columns={"lit_orekit": "lit"})
        tables.write(
            "light", kept, source, "GCRF; lit 1 is full sunlight, a second outside each penumbra and within"
        )
        return {"edges": edges, "light": light}

    def orbits(self) -> dict:
        """Fly our orbits, converged, at half the steps and at the paper's settings; and with DE440."""
        case, with_de440 = self.case, self.environment.with_de440()
        converged = {trajectories.CONVERGED: OURS_CONVERGED}
        others = {
            trajectories.HALVED: trajectories.halved(OURS_CONVERGED),
            trajectories.PAPER: case.integrator,
        }
        self.progress("Our orbits")
        mine = trajectories.opmls(case, self.models, {**converged, **others})
        self.progress("Our orbits with DE440")
        models = {name: with_de440.model(settings) for name, settings in case.models.items()}
        return {"our_orbits": mine, "de440_orbits": trajectories.opmls(case, models, converged)}

    def orekits_orbits(self, awaited: Sequence["Future[list[dict]]"], source: str) -> dict:
        """Collect Orekit's orbits as they come in from the workers."""
        theirs = trajectories.collected(awaited)
        tables.write("orbits", theirs[theirs["integrator"] == trajectories.CONVERGED], source, "GCRF")
        return {"orekit_orbits": theirs}

    def steps(self) -> dict:
        """Measure the paper's steps in the errors to be learned."""
        self.progress("Predictions at the paper's steps and at fine ones")
        return {"effect": steps.effect(self.case, self.models, self.environment.tables["earth_orientation"])}

    def fits(self, source: str) -> dict:
        """Compare least squares on the same measurements."""
        self.progress("Our estimates")
        case, assumed = self.case, self.models["assumed"]
        orientation = self.environment.tables["earth_orientation"]
        truth, measured = estimation.simulated(case, self.models["truth"], orientation, case.integrator)
        mine = estimation.opmls(case, assumed, truth, measured, orientation)
        window = HOUR * case.values["estimation"]["window_hours"]
        chosen = estimation.chosen(mine, window)
        asked = estimation.orekits(self.workers, case, truth, measured, chosen, self.environment.gm)
        theirs = pd.DataFrame([fit.result() for fit in asked])
        both = chosen[chosen["track"].isin(theirs.loc[theirs["reason"] == "", "track"])]
        smallest = both.loc[both["measurements_used"].idxmin(), "track"]
        rows = estimation.window_of(case, measured, smallest)
        rows, estimate = estimation.for_tests(rows, truth, theirs)
        tables.write("measurements", rows, source, "opml's own, noisy and true")
        tables.write("estimate", estimate, source, "GCRF; the true state at each track, Orekit's at the last")
        return {
            "fits": estimation.side_by_side(chosen, theirs, truth),
            "fits_made": len(chosen),
        }
