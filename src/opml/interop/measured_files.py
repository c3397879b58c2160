"""Which files hold measurements of an orbit, points or tracks, and which public element sets."""

from pathlib import Path

from opml.base.files import FilePath
from opml.interop import fixes_csv, tdm
from opml.interop.orbit_arcs import contents
from opml.interop.orbit_from_files import is_orbit


def is_measured(path: FilePath) -> bool:
    """Return whether a file has points (SP3, CPF, OEM, CSV) or tracks; a folder is one of element sets."""
    if Path(path).is_dir():
        return False
    content = contents(path)
    return tdm.matches(content) or is_orbit(content) or fixes_csv.matches(content)
