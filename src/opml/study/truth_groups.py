"""RSOs that are propagated together: the truths of one job, side by side in the lanes of the kernels."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from opml import naming
from opml.base.constants import LANES
from opml.base.errors import InputError
from opml.orbits import sheets
from opml.study.experiments import Study
from opml.tables import TRUTH_GROUPS, read_table


def groups(study: Study, rsos: Iterable[str], *, results: Path) -> list[tuple[str, ...]]:
    """Return the simulated RSOs of each group of two or more.

    rsos: names that the study may simulate
    results: folder of the truths that exist, in `truth`, and of their groups, in `truth_groups`

    A job's truths are made anew together, with all that follows from them. So an RSO with a truth stays with
    its own group, and an RSO that is new to the study is grouped with others that are new. The order is the
    RSOs' own, whichever group is finished first: a job on another machine finds its rule by its number.
    """
    rsos = _simulated_rsos(study, rsos)
    finished = list(_finished_groups(study, rsos, results))
    placed = {rso for group in finished for rso in group}
    waiting = [rso for rso in rsos if rso not in placed and not _has_truth(results, rso)]
    new = [tuple(waiting[k : k + LANES]) for k in range(0, len(waiting), LANES)]
    place = {rso: k for k, rso in enumerate(rsos)}
    together = [group for group in (*finished, *new) if len(group) > 1]
    return sorted(together, key=lambda group: min(place[rso] for rso in group if rso in place))


def _finished_groups(study: Study, rsos: Sequence[str], results: Path) -> Iterator[tuple[str, ...]]:
    """Yield finished groups of RSOs whose truths exist; no RSO is in two.

    A group that today's settings could not repeat is left out.
    """
    placed: set[str] = set()
    for group in map(_read_group, sorted((results / TRUTH_GROUPS).glob("*.parquet"))):
        is_needed = not set(rsos).isdisjoint(group) and placed.isdisjoint(group)
        has_truth = any(_has_truth(results, rso) for rso in group)
        if is_needed and has_truth and len(_simulated_rsos(study, group)) == len(group):
            placed.update(group)
            yield group


def _read_group(path: Path) -> tuple[str, ...]:
    """Return the RSOs of a table of one group; none where the table is damaged."""
    try:
        return tuple(read_table(path, TRUTH_GROUPS)["rso"])
    except InputError:
        return ()


def _simulated_rsos(study: Study, rsos: Iterable[str]) -> list[str]:
    """Return the RSOs that start from the sheet, whose orbit is not from files, nor measured."""
    from_files = {*study.settings.orbits, *study.settings.measured}
    return [rso for rso in rsos if _base(study, rso) not in {None, *from_files}]


def _base(study: Study, rso: str) -> str | None:
    """Return the RSO of the sheet that a name starts from; None where it names no orbit."""
    try:
        sheets.parse_rso(rso, study.sheet)
        return naming.rso_parts(rso, study.sheet)[0]
    except InputError:
        return None


def _has_truth(results: Path, rso: str) -> bool:
    return (results / "truth" / f"{rso}.parquet").exists()
