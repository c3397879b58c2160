"""What several tests share: the paper's epoch, environment, force models, sheets, and outside tables."""

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from opml.config import read_yaml
from opml.constants import BODIES
from opml.dynamics import forces
from opml.dynamics.lanes import WIDTH
from opml.environment import earth_orientation, ephemerides, gravity_field, nodes, solar_activity
from opml.sheets import read_rsos, read_stations

EPOCH = "2016-09-28T12:09:45"
DAY = 86400.0
ASSUMED_BODIES = ("sun", "moon", "jupiter")

REPOSITORY = Path(__file__).parents[1]
EXCERPTS = REPOSITORY / "tests" / "reference"
SHARED = Path(os.environ.get("OPML_SHARED") or REPOSITORY.parent / "shared")


def shared(name):
    """Path of a file that lies beside the repository; skips the test where it is absent."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"needs {name} beside the repository (or under OPML_SHARED)")
    return path


def in_rows(values):
    """Values (n,) as rows of lanes (rows, WIDTH), the last one repeated to fill the last row."""
    values = np.asarray(values, dtype=float)
    return np.pad(values, (0, -len(values) % WIDTH), mode="edge").reshape(-1, WIDTH).copy()


@cache
def environment(days=50.0):
    """The tables of Earth's orientation, the third bodies and the solar activity over the run."""
    t = nodes(EPOCH, days * DAY)
    return {
        "earth_orientation": earth_orientation.tabulate(EPOCH, t),
        "ephemerides": ephemerides.tabulate("DE440", EPOCH, t),
        "solar_activity": solar_activity.tabulate("MSAFE", EPOCH, t, 50),
    }


@cache
def force_model(degree, bodies=BODIES, field="EGM2008"):
    """Tables of a force model under a field given by its name or path."""
    read = gravity_field.read_icgem(gravity_field.resolve(field))
    return forces.build(
        **environment(),
        gravity_field=gravity_field.table(read, EPOCH),
        epoch=EPOCH,
        degree=degree,
        order=degree,
        bodies=bodies,
        gm=read.gm,
        radius=read.radius,
    )


def setting_keys():
    """Keys of all settings of the paper that are no mapping, as tuples; of learners one of each kind."""
    values = read_yaml(REPOSITORY / "config" / "config.yaml")
    kinds = {learner["kind"]: name for name, learner in values["learners"].items()}
    return [key for key in _leaves(values) if key[0] != "learners" or key[1] in kinds.values()]


def _leaves(values, key=()):
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _leaves(value, (*key, name))
        else:
            yield *key, name


@cache
def stations():
    """The paper's stations, by name."""
    return read_stations(REPOSITORY / "config" / "stations.tsv")


@cache
def rsos():
    """The paper's RSOs, by name."""
    return read_rsos(REPOSITORY / "config" / "rsos.tsv")
