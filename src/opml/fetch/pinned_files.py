"""Files of a public address that never change: those of a commit, or of an archive with a DOI."""

import hashlib
from pathlib import Path

from opml.base.errors import InputError
from opml.base.files import data_folder
from opml.base.section import Section
from opml.base.setting_types import Text
from opml.fetch.downloads import Download, Downloads


class PinnedFiles(Section):
    """Files of an address; files: SHA-256 by what of their addresses follows it."""

    address: Text
    files: dict[str, Text]

    def fetch(self) -> list[Path]:
        """Return the paths of the files, each downloaded once into the folder of data.

        Raises InputError for an address that gives none, and for a file of another SHA-256.
        """
        server = Downloads(data_folder() / "pinned")
        return [self._fetch(server, name) for name in self.files]

    def _fetch(self, server: Downloads, name: str) -> Path:
        path, digest = server.path(name), self.files[name]

        def check(content: bytes) -> None:
            if hashlib.sha256(content).hexdigest() != digest:
                raise InputError(f"expected the file of SHA-256 {digest[:12]}, got another")

        if not path.exists() or hashlib.sha256(path.read_bytes()).hexdigest() != digest:
            path.unlink(missing_ok=True)
            server.renew(Download(name, f"{self.address}{name}", hours=0.0, check=check))
        return path
