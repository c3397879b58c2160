"""Which RSOs fly together: the truths of one job, side by side in the lanes of the kernels."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from opml import naming
from opml.base.constants import LANES
from opml.base.errors import InputError
from opml.naming import Experiment
from opml.orbits import sheets
from opml.study.beyond import Beyond
from opml.study.experiments import Study
from opml.study.own_study import Own
from opml.study.paper import Paper
from opml.tables import TRUTH_GROUPS, read_table


def named(paper: Paper, beyond: Beyond, own: Own) -> list[str]:
    """The RSOs that a study's experiments train on and test, each once."""
    experiments = [
        *paper.reported,
        *(beyond.every if "beyond" in beyond.study else []),
        *(own.experiments.values() if own.is_asked else []),
    ]
    pools = beyond.study.entry("pools")
    return list(dict.fromkeys(rso for one in experiments for rso in (*_trained_on(one, pools), one.target)))


def _trained_on(experiment: Experiment, pools: Mapping[str, Sequence[str]]) -> Sequence[str]:
    rso = experiment.rso
    return naming.parse_pool(rso, pools) if naming.WITHOUT in rso else [rso]


def groups(study: Study, rsos: Iterable[str], *, results: Path) -> list[tuple[str, ...]]:
    """The simulated RSOs of each group of two or more.

    results: folder of the truths that are there, in `truth`, and of who flew together, in `truth_groups`.

    A job's truths are made anew together, with all that follows from them. So those that are there stay
    with the RSOs they flew with, and one that is new to the study flies with others that are new. The order
    is the RSOs' own, whichever group is over first: a job on another machine finds its rule by its number.
    """
    rsos = _simulated(study, rsos)
    over = list(_over(study, rsos, results))
    placed = {rso for group in over for rso in group}
    waiting = [rso for rso in rsos if rso not in placed and not _is_there(results, rso)]
    new = [tuple(waiting[k : k + LANES]) for k in range(0, len(waiting), LANES)]
    place = {rso: k for k, rso in enumerate(rsos)}
    together = [group for group in (*over, *new) if len(group) > 1]
    return sorted(together, key=lambda group: min(place[rso] for rso in group if rso in place))


def _over(study: Study, rsos: Sequence[str], results: Path) -> Iterator[tuple[str, ...]]:
    """Finished groups of RSOs whose truths exist; no RSO is in two.

    A group that today's settings could not repeat is left out.
    """
    placed: set[str] = set()
    for group in map(_flown, sorted((results / TRUTH_GROUPS).glob("*.parquet"))):
        asked = not set(rsos).isdisjoint(group) and placed.isdisjoint(group)
        there = any(_is_there(results, rso) for rso in group)
        if asked and there and len(_simulated(study, group)) == len(group):
            placed.update(group)
            yield group


def _flown(path: Path) -> tuple[str, ...]:
    """The RSOs of the group that a table tells of; none where it is damaged."""
    try:
        return tuple(read_table(path, TRUTH_GROUPS)["rso"])
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
