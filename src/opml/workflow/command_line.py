"""Files of settings on Snakemake's command line, looked at before Snakemake reads them.

Snakemake reads them before the Snakefile, and ends in a traceback where one is missing or no text.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from opml.base.errors import InputError
from opml.base.yaml_files import read_yaml

_SUFFIXES = (".yaml", ".yml", ".json")


def check_configfiles(arguments: Sequence[str]) -> None:
    """End the start in one line where a file behind --configfile holds no settings.

    arguments: those of the command line, without the program
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="*", default=[])
    for path in parser.parse_known_args(arguments)[0].configfile:
        try:
            _check(path)
        except InputError as error:
            sys.exit(f"opml: {error}")


def _check(path: str) -> None:
    """Raise InputError for a file that holds no mapping; a name that is none of YAML's may be a target."""
    try:
        values = read_yaml(path)
    except InputError:
        if Path(path).suffix in _SUFFIXES:
            raise
        expected = "expected a file of settings behind --configfile; targets stand before it, or behind --"
        raise InputError(f"{path}: {expected}") from None
    if not isinstance(values, Mapping):
        got = "nothing" if values is None else type(values).__name__
        raise InputError(f"{path}: expected a mapping of settings, got {got}")
