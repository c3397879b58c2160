"""The mechanism's table: the long arc beside the short one, and what stands in where there is none."""

import numpy as np
import pandas as pd
import pytest
from fits import estimates_on, on_orbit

from opml.catalog.predict import mechanism
from opml.catalog.predict.mechanism import FittedArcs
from opml.catalog.predict.resonance import Resonances
from opml.orbits.elements import rsw_rotation
from opml.tables import STATE, mechanism_schema, read_table, write_table

GM = 3.986004415e14
PAIRS = ((1, 15), (2, 31))
T = np.array([0.0, 1e4, 5e4, 9e4])
START, END = np.array([0, 0, 0, 1, 1, 2]), np.array([1, 2, 3, 2, 3, 3])


def estimates(cd, converged=True):
    known = {"cd": cd, "cov_cd_cd": 0.01, "converged": converged, "track": np.arange(4)}
    return estimates_on(T, on_orbit(T, GM), **known)


def predictions(offset):
    """Predictions that are `offset` (6,) off the orbit, in RSW of the orbit."""
    states = on_orbit(T[END], GM)
    moved = np.einsum("nji,kj->nki", rsw_rotation(states), np.reshape(offset, (2, 3))).reshape(-1, 6)
    table = pd.DataFrame({"i": START, "j": END, "t_i": T[START], "t_j": T[END]})
    return table.assign(**dict(zip(STATE, (states + moved).T, strict=True)))


def sensitivities(value):
    names = [f"{family}_{axis}" for family in "sv" for axis in STATE]
    return pd.DataFrame({"i": START, "j": END, **dict.fromkeys(names, value)})


def build(long_cd=(2.1, 2.2, 2.3, 2.4), converged=True, drop=(), bounds=(1.2, 3.2)):
    long_predictions = predictions([1.0, -200.0, 3.0, 0.1, 0.0, 0.0])
    short = FittedArcs(estimates([2.0, 2.5, 2.2, 2.2]), predictions(np.zeros(6)), sensitivities(7.0))
    long = FittedArcs(
        estimates(list(long_cd), converged),
        long_predictions.drop(index=list(drop)),
        sensitivities(11.0).drop(index=list(drop)),
    )
    return mechanism.build(short, long, bounds=bounds, resonances=Resonances(PAIRS, 12, GM))


def test_the_long_arcs_difference_is_in_rsw_of_the_prediction():
    table = build()
    assert set(table.columns) == set(mechanism_schema(PAIRS).names)
    expected = [-1.0, 200.0, -3.0, -0.1, 0.0, 0.0]
    for axis, value in zip(STATE, expected, strict=True):
        np.testing.assert_allclose(table[f"l_{axis}"], value, atol=1e-6)
    assert (table["v_long_y"] == 11.0).all()
    assert (table["v_y"] == 7.0).all()
    np.testing.assert_array_equal(table["cd"], np.array([2.0, 2.5, 2.2])[START])
    np.testing.assert_array_equal(table["cd_long"], np.array([2.1, 2.2, 2.3])[START])
    assert table[["i", "j"]].to_numpy().tolist() == np.stack([START, END], axis=1).tolist()


@pytest.mark.parametrize(
    "without", [{"converged": [True, False, True, True]}, {"long_cd": (2.1, 5.0, 2.3, 2.4)}, {"drop": (3, 4)}]
)
def test_the_short_arc_stands_in_for_a_long_one_that_is_of_no_use(without):
    table, whole = build(**without), build()
    lost = table["i"] == 1
    assert (table.loc[lost, [f"l_{axis}" for axis in STATE]] == 0.0).all(axis=None)
    assert (table.loc[lost, "v_long_y"] == 7.0).all()
    assert (table.loc[lost, "cd_long"] == 2.5).all()
    pd.testing.assert_frame_equal(table.loc[~lost], whole.loc[~lost])


def test_without_bounds_a_long_arc_of_any_cd_is_of_use():
    table = build(long_cd=(2.1, 5.0, 2.3, 2.4), bounds=None)
    np.testing.assert_array_equal(table["cd_long"], np.array([2.1, 5.0, 2.3])[START])
    assert (table["v_long_y"] == 11.0).all()


def test_is_written_as_its_schema_says(tmp_path):
    path, table, schema = tmp_path / "mechanism.parquet", build(), mechanism_schema(PAIRS)
    write_table(path, table, schema, metadata={})
    pd.testing.assert_frame_equal(read_table(path, schema), table[schema.names], check_exact=True)
