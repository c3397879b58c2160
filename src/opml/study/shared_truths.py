"""Which RSOs fly together: the truths of one job, side by side in the lanes of the kernels."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from opml import naming
from opml.base.errors import InputError
from opml.naming import Experiment
from opml.orbits import sheets
from opml.study.beyond import Honest
from opml.study.experiments import Study
from opml.study.own_study import Own
from opml.study.paper import Paper
from opml.tables import FLIGHTS, read_table

LANES = 16
"""Most truths of one job: they take the time of one, as a kernel has that many lanes."""


def named(paper: Paper, honest: Honest, own: Own) -> list[str]:
    """The RSOs that a study's experiments train on and test, each once."""
    experiments = [
        *paper.reported,
        *(honest.every if "generalisation" in honest.study else []),
        *(own.experiments.values() if own.is_asked else []),
    ]
    pools = honest.study.entry("pools")
    return list(dict.fromkeys(rso for one in experiments for rso in (*_trained_on(one, pools), one.target)))


def _trained_on(experiment: Experiment, pools: Mapping[str, Sequence[str]]) -> Sequence[str]:
    rso = experiment.rso
    return naming.parse_pool(rso, pools) if naming.WITHOUT in rso else [rso]


def flights(study: Study, rsos: Iterable[str], *, results: Path) -> list[tuple[str, ...]]:
    """The simulated RSOs of each flight of two or more.

    results: folder of the truths that are there, in `truth`, and of who flew together, in `flights`.

    A job's truths are made anew together, with all that follows from them. So those that are there stay
    with the RSOs they flew with, and one that is new to the study flies with others that are new. The order
    is the RSOs' own, whichever flight is over first: a job on another machine finds its rule by its number.
    """
    rsos = _simulated(study, rsos)
    over = list(_over(study, rsos, results))
    placed = {rso for flight in over for rso in flight}
    waiting = [rso for rso in rsos if rso not in placed and not _is_there(results, rso)]
    new = [tuple(waiting[k : k + LANES]) for k in range(0, len(waiting), LANES)]
    place = {rso: k for k, rso in enumerate(rsos)}
    together = [flight for flight in (*over, *new) if len(flight) > 1]
    return sorted(together, key=lambda flight: min(place[rso] for rso in flight if rso in place))


def _over(study: Study, rsos: Sequence[str], results: Path) -> Iterator[tuple[str, ...]]:
    """The flights of some RSOs that are over, a truth of each there; no RSO is in two.

    One that could not be flown again as it was is none.
    """
    placed: set[str] = set()
    for flight in map(_flown, sorted((results / FLIGHTS).glob("*.parquet"))):
        asked = not set(rsos).isdisjoint(flight) and placed.isdisjoint(flight)
        there = any(_is_there(results, rso) for rso in flight)
        if asked and there and len(_simulated(study, flight)) == len(flight):
            placed.update(flight)
            yield flight


def _flown(path: Path) -> tuple[str, ...]:
    """The RSOs of the flight that a table tells of; none where it is damaged."""
    try:
        return tuple(read_table(path, FLIGHTS)["rso"])
    except InputError:
        return ()


def _simulated(study: Study, rsos: Iterable[str]) -> list[str]:
    """Those of some RSOs that the sheet has, without an orbit or tracks of their own."""
    given = {*study.settings.orbits, *study.settings.tracks}
    return [rso for rso in rsos if _base(study, rso) not in {None, *given}]


def _base(study: Study, rso: str) -> str | None:
    """The RSO of the sheet that a name starts from; None where it names no orbit."""
    try:
        sheets.parse_rso(rso, study.sheet)
        return naming.rso_parts(rso, study.sheet)[0]
    except InputError:
        return None


def _is_there(results: Path, rso: str) -> bool:
    """Whether there is a truth of an RSO."""
    return (results / "truth" / f"{rso}.parquet").exists()
