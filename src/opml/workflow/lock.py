"""One run at a time in a folder of results.

The lock is the operating system's (flock): it ends with the process that holds it, however that ends.
"""

import fcntl
import os
import socket
from datetime import UTC, datetime
from pathlib import Path
from typing import IO

from opml.base.errors import InputError

NAME = "logs/.running"  # file in a folder of results that names the run that holds the folder
_held: list[IO[str]] = []  # open for as long as the process lives


def hold(results: Path) -> IO[str]:
    """Hold a folder of results for this process, or until the file that it returns is closed.

    Raises InputError, with the holder, where another process holds it.
    """
    path = results / NAME
    path.parent.mkdir(parents=True, exist_ok=True)
    file = path.open("a+", encoding="utf-8")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.seek(0)
        holder = file.read().strip() or "another process"
        file.close()
        message = f"{results}: expected no other run in this folder of results, but {holder} runs in it"
        raise InputError(message) from None
    file.truncate(0)
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    file.write(f"process {os.getpid()} on {socket.gethostname()} (since {now})\n")
    file.flush()
    _held.append(file)
    return file
