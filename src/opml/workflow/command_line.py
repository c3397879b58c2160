"""Settings on Snakemake's command line, looked at before Snakemake reads them.

Snakemake reads them before the Snakefile, and ends in a traceback where a file is missing or no text.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from opml.base.errors import InputError
from opml.base.yaml_files import read_yaml

_TARGETS = "targets are before it, or after --"
_SUFFIXES = (".yaml", ".yml", ".json")


def check_settings(arguments: Sequence[str]) -> None:
    """End the start in one line where what stands behind --configfile or --config is no file or no setting.

    arguments: those of the command line, without the program
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="*", default=[])
    parser.add_argument("--config", "-C", nargs="*", default=[])
    options, _ = parser.parse_known_args(arguments)
    try:
        for path in options.configfile:
            _check_file(path)
        for text in options.config:
            if "=" not in text:
                raise InputError(f"{text}: expected KEY=VALUE after --config; {_TARGETS}")
    except InputError as error:
        sys.exit(f"opml: {error}")


def _check_file(path: str) -> None:
    """Raise InputError for a file that holds no mapping; a name that is none of YAML's may be a target."""
    try:
        values = read_yaml(path)
    except InputError:
        if Path(path).suffix in _SUFFIXES:
            raise
        raise InputError(f"{path}: expected a file of settings after --configfile; {_TARGETS}") from None
    if not isinstance(values, Mapping):
        got = "nothing" if values is None else type(values).__name__
        raise InputError(f"{path}: expected a mapping of settings, got {got}")
