"""Calibrations of orbits inside sets in a file, from one morning to the next.

A key has the day of a calibration and a digest of all that makes it (`inside_now.find`), so one that is read
is the one that would be made.
"""

import logging
import zipfile
from collections.abc import Mapping
from datetime import date, timedelta

import numpy as np
import pandas as pd

from opml.base.files import FilePath, replacing
from opml.element_sets.inside.inside_now import CALIBRATED_EVERY
from opml.element_sets.inside.past_orbits import ERRORS, Calibration, FitSpan

_DAY = len("2016-09-28")

_log = logging.getLogger(__name__)


def read(path: FilePath) -> dict[str, Calibration]:
    """Return the calibrations of a file by key: none where it is missing or, with a warning, damaged."""
    try:
        with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as file:
            keys, numbers, errors = (file[name] for name in ("keys", "numbers", "errors"))
        kept = {}
        for key, (before, after, r, w, sunlight, begin, end) in zip(keys, numbers.tolist(), strict=True):
            own = pd.DataFrame(errors[int(begin) : int(end)], columns=ERRORS)
            kept[str(key)] = Calibration(FitSpan(before, after), r, w, sunlight, own)
    except FileNotFoundError:
        return {}
    except (ValueError, KeyError, IndexError, TypeError, EOFError, OSError, zipfile.BadZipFile):
        _log.warning("%s: damaged; calibrations of orbits inside sets are made anew", path)
        return {}
    return kept


def write(path: FilePath, kept: Mapping[str, Calibration]) -> None:
    """Write calibrations, without those that hold no longer on the last of their days.

    Raises InputError as `files.replacing`.
    """
    if not kept:
        return
    last = max(date.fromisoformat(key[:_DAY]) for key in kept)
    oldest = str(last - timedelta(days=CALIBRATED_EVERY - 1))
    keys = sorted(key for key in kept if key >= oldest)
    tables = [kept[key].errors.to_numpy(float) for key in keys]
    ends = np.cumsum([len(one) for one in tables])
    numbers = []
    for key, table, end in zip(keys, tables, ends, strict=True):
        span, r, w, sunlight, _ = kept[key]
        numbers.append([span.before, span.after, r, w, sunlight, end - len(table), end])
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, keys=np.array(keys), numbers=np.array(numbers), errors=np.concatenate(tables))
