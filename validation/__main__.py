"""Runs opml and Orekit side by side; writes docs/tables/orekit.md and the tables that tests read."""

import argparse
import sys
import time
from pathlib import Path

from opml.base.errors import InputError
from validation.case import Case


def main() -> int:
    """Run the comparison; returns the process's exit status."""
    parser = argparse.ArgumentParser(prog="python -m validation", description=__doc__)
    parser.add_argument(
        "--orekit-data", type=Path, required=True, metavar="DIR", help="a copy of Orekit's data"
    )
    arguments = parser.parse_args()
    try:
        _run(arguments.orekit_data)
    except InputError as reason:
        print(reason, file=sys.stderr)
        return 2
    return 0


def _run(directory):
    try:
        from validation import comparison, orekit
    except ModuleNotFoundError as reason:
        raise InputError(f"{reason.name}: expected the extra `verify` to be installed, got none") from None
    data = orekit.Data.find(directory)
    orekit.start(data)
    comparison.run(Case.read(), data, progress=_progress)


def _progress(text):
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


sys.exit(main())
