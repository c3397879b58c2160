"""What several tests share: the paper's epoch, environment, force models, sheets, and outside tables."""

import json
import os
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from unchanged import made_once

from opml.base.constants import BODIES, DAY, EARTH_GM
from opml.base.errors import InputError
from opml.catalog.fit.estimation_settings import Estimation
from opml.dynamics import forces
from opml.dynamics.kernels.lanes import WIDTH
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings
from opml.environment import celestial_bodies, earth_orientation, gravity_field, nodes, solar_activity
from opml.orbits.elements import cartesian_from_coe, true_from_mean_anomaly
from opml.orbits.sheets import Station, read_rsos, read_stations
from opml.study.experiments import Study
from opml.study.settings.merging import merged, with_sheets
from opml.study.settings.overlay import Source
from opml.tables import STATE

EPOCH = "2016-09-28T12:09:45"
ASSUMED_BODIES = ("sun", "moon", "jupiter")
ESTIMATION = Estimation(
    window_hours=12,
    max_iterations=30,
    convergence=1e-3,
    start_position_sigma_m=1000.0,
    start_velocity_sigma_mps=1.0,
    least_drag_m=0.1,
)
BOUNDED_ESTIMATION = ESTIMATION.evolve(cd_bounds=(1.2, 3.2))
"""Settings of fits that take an estimate of an absurd drag coefficient for no start."""

EARTH = pd.DataFrame(
    {"t": np.arange(-2, 4) * DAY}
    | dict.fromkeys(["x_cip", "y_cip", "s_cio", "x_pole", "y_pole", "era_offset"], 0.0)
)
"""An Earth orientation table without precession, polar motion and corrections."""

RADAR = Station(
    name="radar",
    latitude=0.0,
    longitude=np.radians(170.0),
    altitude=0.0,
    max_range=1e9,
    min_elevation=0.0,
    max_elevation=np.pi / 2,
    sigma_range=1.0,
    sigma_azimuth=1e-3,
    sigma_elevation=1e-3,
)
"""A station on the equator that sees everything above its horizon."""

REPOSITORY = Path(__file__).parents[1]
EXCERPTS = REPOSITORY / "tests" / "reference"
SHARED = Path(os.environ.get("OPML_SHARED") or REPOSITORY.parent / "shared")


def shared(name):
    """Path of a file that lies beside the repository; skips the test where it is absent."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"needs {name} beside the repository (or under OPML_SHARED)")
    return path


def edited(path, old, new):
    """A file in which one piece of text, which it has, is another."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    return path


def refusal(read, *given, **options):
    """The one line in which a reader, or anything else, says what it refuses."""
    with pytest.raises(InputError) as error:
        read(*given, **options)
    line = str(error.value)
    assert "\n" not in line
    return line


def refusals(name):
    """Cases of a table in tests/refusals, a line each: what is wrong, and what is said of it."""
    cases = yaml.safe_load((REPOSITORY / "tests" / "refusals" / f"{name}.yaml").read_text(encoding="utf-8"))
    named = [case.popitem() if isinstance(case, dict) else (None, case) for case in cases]
    return [pytest.param(*values, id=identity) for identity, values in named]


def in_rows(values):
    """Values (n,) as rows of lanes (rows, WIDTH), the last one repeated to fill the last row."""
    values = np.asarray(values, dtype=float)
    return np.pad(values, (0, -len(values) % WIDTH), mode="edge").reshape(-1, WIDTH).copy()


@made_once
def environment(days=50.0):
    """The tables of Earth's orientation, the third bodies and the solar activity over the run."""
    t = nodes(EPOCH, days * DAY)
    return {
        "earth_orientation": earth_orientation.tabulate(EPOCH, t),
        "ephemerides": celestial_bodies.tabulate(EPOCH, t),
        "solar_activity": solar_activity.tabulate("MSAFE", EPOCH, t, 50),
    }


@made_once
def force_model(degree, bodies=BODIES, field="EGM2008"):
    """A force model under a field given by its name or path."""
    settings = ForceModelSettings(degree=degree, order=degree, third_bodies=list(bodies))
    return forces.build(surroundings(field), settings)


@made_once
def precise_model(degree):
    """A force model with tides and relativity."""
    settings = ForceModelSettings(
        degree=degree, order=degree, third_bodies=list(BODIES), forces=["solid_tides", "relativity"]
    )
    return forces.build(surroundings("EGM2008"), settings)


def surroundings(field):
    read = gravity_field.read_icgem(gravity_field.resolve(field))
    return Environment(
        EPOCH,
        **environment(),
        gravity_field=gravity_field.table(read, EPOCH),
        gm=read.gm,
        radius=read.radius,
        tide_system=read.tide_system,
    )


@cache
def _paper() -> Source:
    """The paper's settings as a run has them, with their files, from the repository's root."""
    before = Path.cwd()
    try:
        os.chdir(REPOSITORY)
        return merged(["config/config.yaml"])
    finally:
        os.chdir(before)


def paper_source():
    """The paper's settings and the files that they come from; the settings may be changed."""
    source = _paper()
    # Apart from each other, unlike what YAML's anchors share.
    return Source(json.loads(json.dumps(source.values)), source.layers)


def paper_values():
    """The paper's settings, to be changed; the sheets' paths hold from any folder."""
    values = paper_source().values
    values["sheets"] = {kind: str(REPOSITORY / path) for kind, path in values["sheets"].items()}
    return values


def study_of(values):
    """The study of settings."""
    return Study(with_sheets(values))


def setting_keys():
    """Keys of all settings of the paper that are no mapping, as tuples; of learners one of each kind."""
    values = paper_values()
    kinds = {learner["kind"]: name for name, learner in values["learners"].items()}
    return [key for key in _leaves(values) if key[0] != "learners" or key[1] in kinds.values()]


def _leaves(values, key=()):
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _leaves(value, (*key, name))
        else:
            yield *key, name


@made_once
def stations():
    """The paper's stations, by name."""
    return read_stations(REPOSITORY / "config" / "stations.tsv")


@made_once
def rsos():
    """The paper's RSOs, by name."""
    return read_rsos(REPOSITORY / "config" / "rsos.tsv")


def kepler_orbit(rso, *, duration, step):
    """The `truth` table of an RSO that a point mass alone attracts, every `step` to `duration` [s]."""
    t = np.arange(0.0, duration + 0.5 * step, step)
    coe = np.tile([rso.a, rso.e, rso.i, rso.argp, rso.raan, 0.0], (len(t), 1))
    mean_anomaly = rso.mean_anomaly + np.sqrt(EARTH_GM / rso.a**3) * t
    coe[:, 5] = true_from_mean_anomaly(mean_anomaly, coe[:, 1])
    return pd.DataFrame(cartesian_from_coe(coe, EARTH_GM), columns=STATE).assign(t=t)[["t", *STATE]]
