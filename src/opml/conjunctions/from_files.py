"""Conjunctions in files: one object against others, all of a catalogue, or those of messages."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import cdm, screening
from opml.conjunctions.conjunction import Conjunction
from opml.interop import formats
from opml.interop.element_sets.element_set import of_files
from opml.interop.ephemeris import EPOCH


def conjunctions(
    files: Sequence[FilePath],
    *,
    within: float | None,
    radius: float | None,
    days: float,
    weather: FilePath = "OBSERVED",
) -> Iterable[Conjunction]:
    """Return the conjunctions of the first file's object, of all pairs in a file alone, or of CDMs.

    files: a folder stands for all files in it; of all but the first some that cannot be read are skipped

    within: largest distance [km], None: the usual one
    radius: sum of the radii of two objects [m], None: the usual one, or the CDM's
    days: that mean elements are propagated where no file is an orbit
    weather: OBSERVED, the packaged one, or a CSSI file, under which element sets are predicted

    Raises InputError for a distance with a CDM, and as `screen`, `screen_all` and `cdm.read`.
    """
    first, *others = (_files_of(Path(path)) for path in files)
    rest = [file for folder in others for file in folder]
    known = of_files(first, _kind_of) + of_files(rest, _kind_of)
    files = [path for path, _ in known]
    if {kind for _, kind in known} == {formats.CONJUNCTION}:
        if within is not None:
            raise InputError("--within: expected ephemerides to screen, got a conjunction data message")
        return [one for path in files for one in cdm.read(path, epoch=EPOCH, radius=radius)]
    radius = screening.RADIUS if radius is None else radius
    metres = 1e3 * (screening.WITHIN if within is None else within)
    if len(files) == 1:
        return screening.screen_all(files[0], days=days, within=metres, radius=radius)
    return screening.screen(screening.read(files, days=days, weather=weather), within=metres, radius=radius)


def _kind_of(path: FilePath) -> list[tuple[FilePath, str]]:
    return [(path, formats.kind_of(path, formats.CONJUNCTION, formats.ORBIT, formats.ELEMENTS))]


def _files_of(path: Path) -> list[Path]:
    """Return a path, or the files of a folder by their names. Raises InputError for an empty one."""
    files = sorted(file for file in path.rglob("[!.]*") if file.is_file()) if path.is_dir() else [path]
    if not files:
        raise InputError(f"{path}: expected a folder with files, got an empty one")
    return files
