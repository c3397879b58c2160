"""Tides of the solid Earth: the changes of coefficients, and the weights that they change."""

import numba
import numpy as np
import pandas as pd
import pytest
from support import EPOCH, environment, precise_model, rsos

from opml.base.constants import BODIES, DAY, EARTH_RATE, GM, HOUR
from opml.base.errors import InputError
from opml.catalog.simulate.truth import initial_state
from opml.dynamics import force_model, solid_tides
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.kernels import surroundings, tides
from opml.dynamics.kernels.gravity import weights
from opml.dynamics.kernels.surroundings import TIDE
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.environment import celestial_bodies, earth_orientation, gravity_field
from opml.tables import write_table

FIELD = {"gm": 3.986004415e14, "radius": 6378136.3}
C20 = 2 * tides.TERMS.index((2, 0))


@numba.njit(cache=True, error_model="numpy")
def _look_up(t, model, values, factors):
    surroundings.look_up(t, model, values, factors)


@numba.njit(cache=True, error_model="numpy")
def _add(values, first, risen, flown):
    tides.add(values, first, risen, flown)


def nodes(t, tide_system="tide_free"):
    """Changes of coefficients (n, COLUMNS) at times t (n,) [s], n from 6."""
    of_earth, bodies = earth_orientation.tabulate(EPOCH, t), celestial_bodies.tabulate(EPOCH, t)
    nothing = pd.DataFrame()
    return solid_tides.nodes(
        Environment(EPOCH, of_earth, bodies, nothing, nothing, **FIELD, tide_system=tide_system)
    )


def at(t):
    """Changes at a time as complex numbers C - iS (terms,) of the turning Earth."""
    near = t + 600.0 * np.arange(-2, 4)
    changes = nodes(near)[2]
    offset = earth_orientation.tabulate(EPOCH, near)["era_offset"][2]
    return (changes[::2] - 1j * changes[1::2]) * np.exp(1j * tides.ORDERS * (offset + EARTH_RATE * t))


def test_between_hourly_nodes_the_tide_is_that_of_the_time():
    model = precise_model(8).for_block(np.array([-1]))
    sizes = []
    for t in DAY * np.array([0.3, 3.01, 17.25, 28.6, 40.77, 49.9]):
        values, factors = surroundings.allocate(model)
        _look_up(t, model, values, factors)
        found, expected = values[TIDE : TIDE + tides.COLUMNS], at(t)
        np.testing.assert_allclose(found[::2] - 1j * found[1::2], expected, rtol=0.0, atol=1e-18)
        sizes.append(np.abs(expected))
    # The bound is a part in a billion of the largest, and in a million of the smallest, of degree 4.
    assert np.max(sizes) > 1e-9
    assert np.max(sizes, axis=0).min() > 1e-12


@pytest.mark.parametrize(("degree", "order"), [(4, 3), (6, 6), (9, 5)])
def test_the_weights_with_tides_are_those_of_the_coefficients_with_tides(degree, order):
    rng = np.random.default_rng(degree)
    c, s = rng.normal(size=(2, degree + 1, order + 1))
    still = weights(c, s)
    risen = tides.tides(np.empty((0, tides.COLUMNS)), still, degree)
    changes = rng.normal(size=tides.COLUMNS)
    for k, (n, m) in enumerate(tides.TERMS):
        c[n, m] += changes[2 * k]
        s[n, m] += changes[2 * k + 1] if m > 0 else 0.0
    flown = still.copy()
    for _ in range(3):  # each time from the weights without tides
        _add(np.append(np.zeros(2), changes), 2, risen, flown)
    np.testing.assert_allclose(flown, weights(c, s), rtol=1e-13, atol=1e-13)


def test_a_zero_tide_field_has_the_permanent_tide_already():
    t = HOUR * np.arange(6.0)
    without = nodes(t) - nodes(t, "zero_tide")
    np.testing.assert_allclose(without[:, C20], -4.2008e-9, rtol=1e-4)
    np.testing.assert_array_equal(np.delete(without, C20, axis=1), 0.0)


def test_the_mean_of_a_year_in_c20_is_the_permanent_tide():
    t = 6 * HOUR * np.arange(0.0, 365.25 * 4)
    # In 2016 the Moon stays close to the equator, and pulls more there than in the mean of 18.6 years.
    assert nodes(t)[:, C20].mean() == pytest.approx(-4.5e-9, rel=0.05)


@pytest.mark.parametrize("tide_system", ["mean_tide", "unknown"])
def test_fields_of_another_tide_system_are_refused(tide_system):
    with pytest.raises(
        InputError, match=f"solid_tides: expected .* tide_free or zero_tide, got .*{tide_system}"
    ):
        nodes(HOUR * np.arange(6.0), tide_system)


def departures(names):
    starts = np.array([initial_state(rsos()[name], FIELD["gm"]) for name in names])
    count = len(names)
    ballistic = [rsos()[name].cd * rsos()[name].area_to_mass for name in names]
    reflection = [rsos()[name].cr * rsos()[name].area_to_mass for name in names]
    return Departures(starts, np.zeros(count, int), np.full(count, 3), ballistic, reflection)


def flown(model, names, **options):
    """States (3, 6) of arcs of six hours, by name."""
    arcs = propagate(model, 2 * HOUR * np.arange(4), departures(names), integrator=Integrator(), **options)
    return {name: arcs.path(k).copy() for k, name in enumerate(names)}


def test_tides_of_zero_change_no_bit():
    model = precise_model(8)
    still = model._replace(tides=tides.no_tides())
    zero = model._replace(tides=model.tides._replace(nodes=np.zeros_like(model.tides.nodes)))
    np.testing.assert_array_equal(flown(zero, ["iss"])["iss"], flown(still, ["iss"])["iss"])
    assert np.abs(flown(model, ["iss"])["iss"] - flown(still, ["iss"])["iss"])[:, :3].max() > 0.1


def test_arcs_do_not_depend_on_their_neighbours_and_leave_the_model_as_it_is():
    model = precise_model(8)
    before = model.weights.copy()
    names = list(rsos())
    many = flown(model, [*names, *reversed(names), *names], threads=2)
    for name in ("iss", names[-1]):
        np.testing.assert_array_equal(flown(model, [name])[name], many[name])
    np.testing.assert_array_equal(model.weights, before)


def test_a_field_without_harmonics_has_tides_all_the_same():
    assert precise_model(0).degree == tides.DEGREE + 1
    assert precise_model(0).weights[:, 1:].any() == np.False_
    moved = (
        flown(precise_model(0), ["iss"])["iss"]
        - flown(precise_model(0)._replace(tides=tides.no_tides()), ["iss"])["iss"]
    )
    assert np.abs(moved)[:, :3].max() > 0.1


def test_a_run_has_the_forces_of_its_settings(tmp_path):
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008")).truncate(8, 8)
    frames = environment() | {"gravity_field": gravity_field.table(field, EPOCH)}
    facts = {"gravity_field": gravity_field.metadata(field), "ephemerides": {"gm": GM}}
    paths = {name: str(tmp_path / f"{name}.parquet") for name in frames}
    for name, frame in frames.items():
        write_table(paths[name], frame, name, metadata=facts.get(name, {}))
    settings = ForceModelSettings(degree=8, order=8, third_bodies=list(BODIES))
    plain = force_model.read(paths, epoch=EPOCH, settings=settings)
    assert len(plain.tides.nodes) == plain.columns_of_added.size == 0
    precise = settings.evolve(forces=["solid_tides", "relativity"])
    both = force_model.read(paths, epoch=EPOCH, settings=precise)
    np.testing.assert_array_equal(both.tides.nodes, precise_model(8).tides.nodes)
    np.testing.assert_array_equal(both.columns_of_added, precise_model(8).columns_of_added)
