"""Which files hold measurements of an orbit, points or tracks, and which public element sets."""

from pathlib import Path

from opml.base.files import FilePath
from opml.interop import fixes_csv, tdm
from opml.interop.orbit_arcs import contents
from opml.interop.orbit_from_files import is_orbit


def is_measured(path: FilePath) -> bool:
    """Return whether a file has points or tracks; a folder is one of element sets."""
    return not Path(path).is_dir() and (has_tracks(path) or has_points(path))


def has_tracks(path: FilePath) -> bool:
    """Return whether a file is a TDM."""
    return tdm.matches(contents(path))


def has_points(path: FilePath) -> bool:
    """Return whether a file is an orbit in SP3, CPF or OEM, or points in CSV."""
    content = contents(path)
    return is_orbit(content) or fixes_csv.matches(content)
