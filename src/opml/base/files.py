"""Paths of a project's files; whole files and folders: a temporary one takes the name when it is complete."""

import errno
import gzip
import io
import os
import tempfile
import zlib
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import platformdirs

from opml.base.errors import InputError

_REFUSED = (
    *(errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM),
    *(errno.EEXIST, errno.ENOTDIR, errno.ENAMETOOLONG),
)
"""Reasons of the operating system's not to write a file: no space, no permission, no such name."""

FilePath = str | os.PathLike[str]  # a path as text or as a path object

PROJECT = Path(__file__).parents[1] / "workflow" / "project"
"""Folder of the workflow's files in the package, the settings among them."""

MANUAL = Path(__file__).parents[1] / "manual" / "docs"  # folder of the documentation's pages in the package
PACKAGED = PROJECT / "config" / "config.yaml"  # settings of a run that come with the package

_GZIPPED = b"\x1f\x8b"
_MOST_PACKED = 200  # times that numbers as text are longer than their gzip at most; blank lines: 1000 times
_SMALL = 2**20  # bytes that any file may have


def project_file(path: FilePath) -> Path:
    """Return the path of a project's file; where the project has none, that of the package's own file."""
    packaged = PROJECT / path
    return packaged if packaged.is_file() and not Path(path).exists() else Path(path)


def data_folder() -> Path:
    """Return the folder of what `opml fetch` fetched: that in OPML_DATA, or the user's own."""
    return Path(os.environ.get("OPML_DATA") or platformdirs.user_data_dir("opml"))


def unpacked(content: bytes) -> bytes:
    """Return the bytes of a file, plain or gzipped.

    Raises EOFError, OSError or zlib.error for a gzip that is damaged, or of hardly more than blanks.
    """
    if not content.startswith(_GZIPPED):
        return content
    most = _SMALL + _MOST_PACKED * len(content)
    with gzip.open(io.BytesIO(content)) as file:
        plain = file.read(most + 1)
    if len(plain) > most:
        raise gzip.BadGzipFile(f"a gzip of more than {_MOST_PACKED} times its size")
    return plain


def read_text(path: FilePath, what: str, *, encoding: str = "utf-8") -> str:
    """Read a file as text, plain or gzipped. Raises InputError where it is missing, or not what it should be.

    what: the file should be, in words
    """
    try:
        return unpacked(Path(path).read_bytes()).decode(encoding)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (EOFError, OSError, ValueError, zlib.error) as reason:
        raise InputError(f"{path}: expected {what} ({reason})") from None


def suffix_of(path: FilePath, allowed: Collection[str]) -> str:
    """Return a path's suffix in small letters. Raises InputError where it is none of those allowed."""
    suffix = Path(path).suffix.lower()
    if suffix not in allowed:
        raise InputError(f"{path}: expected a suffix {', '.join(allowed)}, got {suffix or 'none'}")
    return suffix


def check_distinct_files(written: Iterable[FilePath], read: Iterable[FilePath]) -> None:
    """Raise InputError where a file would be written twice, over a folder or what is read, or not at all."""
    taken = {Path(path).resolve() for path in read}
    for path in written:
        if Path(path).is_dir():
            raise InputError(f"{path}: expected a file to write, got a folder")
        if (whole := Path(path).resolve()) in taken:
            raise InputError(f"{path}: expected another file for what is written, got one that is in use")
        taken.add(whole)
        check_folder(path)


def check_folder(path: FilePath) -> None:
    """Raise InputError where the folder of a path, or the first above it that exists, takes no files."""
    folder = next(parent for parent in Path(path).resolve().parents if parent.exists())
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        got = f"{folder}: {os.strerror(error.errno or 0)}"
        raise InputError(f"{path}: expected a folder that can be written to, got {got}") from None


@contextmanager
def writable(path: FilePath) -> Iterator[None]:
    """Raise InputError, naming a path, where the disk takes no more, or the folder cannot be written to."""
    try:
        yield
    except OSError as error:
        if error.errno not in _REFUSED:
            raise
        reason = os.strerror(error.errno)
        raise InputError(f"{path}: expected a file that can be written, got {reason}") from None


@contextmanager
def replacing(path: FilePath) -> Iterator[Path]:
    """Make the folder of `path`; yield a temporary path there, which becomes `path` if nothing is raised.

    Raises InputError where the disk takes no more, or the folder cannot be written to.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with writable(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
            os.replace(temporary, path)
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_text(path: FilePath, text: str) -> None:
    """Write a file of text in UTF-8, whole or not at all. Raises InputError as `replacing`."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@contextmanager
def replacing_folder(path: FilePath) -> Iterator[Path]:
    """Yield a new folder, which takes the place of `path` and all that is in it if nothing is raised.

    Raises InputError as `replacing`.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    place = tempfile.TemporaryDirectory(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent)
    with writable(path), place as temporary:
        new, old = Path(temporary, "new"), Path(temporary, "old")
        new.mkdir()
        yield new
        if path.exists():
            os.replace(path, old)
        os.replace(new, path)
