"""opml's side of docs/tables/orekit.md, against the numbers that Orekit left in validation_*.csv."""

import numpy as np
import pandas as pd
import pytest
from support import ASSUMED_BODIES, EPOCH, environment, refusal, rsos, stations

from opml.base.constants import BODIES, GM, HOUR
from opml.base.errors import InputError
from opml.catalog.associate import quarantine
from opml.catalog.fit import observations, start_states
from opml.catalog.propagator import Propagator
from opml.dynamics.settings import Integrator
from opml.environment import earth_orientation
from opml.tables import STATE
from validation import ours, tables, terms, trajectories
from validation.case import OURS_CONVERGED, PRECISE, Case

FIELD = {"gm": 3.986004415e14, "radius": 6378136.46, "tide_system": "tide_free"}
"""Of EIGEN-6S, as in the head of validation_gravity.csv."""

MODELS = {
    "truth": {"degree": 40, "order": 40, "third_bodies": list(BODIES)},
    "assumed": {"degree": 20, "order": 20, "third_bodies": list(ASSUMED_BODIES)},
}
MODELS[PRECISE] = MODELS["assumed"] | {"forces": ["solid_tides", "relativity"]}


def around(t):
    """The environment that Orekit had at time t [s], on the six nodes about it."""
    nodes = tables.read("nodes")
    near = nodes[np.abs(nodes["t"] - t) <= 3 * HOUR].reset_index(drop=True)
    activity = ["f107", "f107_mean", "kp_3h", "kp_24h"]
    return ours.Environment(
        epoch=EPOCH,
        tables={
            "earth_orientation": earth_orientation.tabulate(EPOCH, near["t"].to_numpy()),
            "ephemerides": near.drop(columns=activity),
            "solar_activity": near[["t", *activity]],
            "gravity_field": tables.read("gravity"),
        },
        gms=tables.read("bodies").set_index("body")["gm"].to_dict(),
        **FIELD,
    )


@pytest.fixture(scope="module")
def product():
    """The product's own environment with Orekit's gravity field."""
    return ours.Environment(
        epoch=EPOCH, tables={**environment(), "gravity_field": tables.read("gravity")}, gms=GM, **FIELD
    )


@pytest.fixture(scope="module")
def both_sides():
    """Orekit's terms and ours at the same states."""
    theirs = tables.read("terms")
    parts = []
    for t, states in theirs.groupby("t"):
        models = {name: around(t).model(settings) for name, settings in MODELS.items()}
        places = states[terms.ITRF].to_numpy()
        parts.append(terms.opmls(models, rsos(), stations(), states, places))
    return theirs, pd.concat(parts).loc[theirs.index]


def test_every_term_is_orekits_to_its_bound(both_sides):
    theirs, mine = both_sides
    found = terms.differences(Case.read(), theirs, mine)
    assert {d.term: d.largest for d in found if d.largest > d.bound} == {}
    assert len(found) == 24


def test_the_states_are_of_all_rsos_and_at_several_times():
    theirs = tables.read("terms")
    assert set(theirs["rso"]) == set(rsos())
    assert theirs["t"].nunique() >= 4
    assert 0.0 < theirs["lit"].mean() < 1.0


def test_light_in_the_penumbra_is_orekits(product):
    model = product.model(MODELS["truth"])
    light = tables.read("light")
    found = np.array(
        [
            ours.terms(model, row.t, row[STATE].to_numpy(float), rsos()[row.rso])["lit"]
            for _, row in light.iterrows()
        ]
    )
    # A second outside the penumbra the light is whole or none; within, DE440's Sun is 100 m off DE430's.
    outside = light["lit"].isin([0.0, 1.0]).to_numpy()
    np.testing.assert_array_equal(found[outside], light["lit"][outside])
    np.testing.assert_allclose(found[~outside], light["lit"][~outside], rtol=1e-6)
    assert outside.sum() == 2 * len(light) // 5


@pytest.mark.parametrize("name", ["assumed", PRECISE])
def test_orbits_are_orekits_after_a_week(product, name):
    model = {name: product.model(MODELS[name])}
    mine = trajectories.opmls(Case.read(), model, {trajectories.CONVERGED: OURS_CONVERGED})
    apart = trajectories.apart(mine, tables.read("orbits"), trajectories.KEYS)
    assert len(apart) == 3 * len(rsos())
    # The product's kernel is DE440, Orekit's was DE430: millimetres in a week.
    assert apart.max() < 1.0


def test_the_estimate_from_the_same_measurements_is_orekits(product):
    case, rows, expected = Case.read(), tables.read("measurements"), tables.read("estimate")
    found = quarantine.estimate_all(
        Propagator(product.model(MODELS["assumed"]), rsos()["iss"], Integrator(position_tolerance_m=1e-4)),
        start_states.perturbed(expected, rows, rso="iss", settings=case.estimation, seed=1),
        observations.Measured(rows, environment()["earth_orientation"], list(stations().values())),
        settings=case.estimation,
    ).iloc[-1]
    last = expected.iloc[-1]
    assert found["converged"]
    difference = found[STATE].to_numpy(float) - last[[f"{name}_orekit" for name in STATE]].to_numpy(float)
    assert np.linalg.norm(difference[:3]) < 0.5
    assert abs(found["cd"] - last["cd_orekit"]) < 1e-3


def test_an_incomplete_folder_of_orekits_data_is_named_with_what_it_lacks(tmp_path):
    pytest.importorskip("orekit_jpype", reason="needs the extra `verify`")
    from validation.orekit import Data

    assert "none: expected a folder" in refusal(Data.find, tmp_path / "none")
    for name in ("tai-utc.dat", "itrf-versions.conf", "finals2000A.all", "lnxp1516.430", "jan2017f10.txt"):
        (tmp_path / name).touch()
    with pytest.raises(InputError, match=r"no file for gravity field \(eigen-6s.gfc\)$"):
        Data.find(tmp_path)
