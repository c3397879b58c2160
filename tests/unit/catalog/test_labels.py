"""Labels from later estimates: their numbers, when they are known, and that nothing measured later leaks."""

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION as SETTINGS

from opml.base.constants import DAY
from opml.catalog.associate import quarantine
from opml.catalog.fit import observations, start_states
from opml.catalog.predict import labels, other_windows, prediction, sensitivity
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.learning.data import dataset, splits
from opml.learning.data.cleaning import Cleaning
from opml.learning.models import learners
from opml.learning.models.training_inputs import Training, inverse_variances
from opml.tables import (
    COMPONENTS,
    LEARNING_VARIABLES,
    PARAMETER_COVARIANCES,
    SCHEMAS,
    SIGMAS,
    STATE,
    write_table,
)

END_OF_TRAINING = DAY
TRAIN = "days-0-1"
CLEANING = Cleaning(fence=20.0, fence_days=(0.0, 1.0))
LEARNERS = {
    "svr": {"kind": "svr", "kernel_scale": "sigest", "c": 1.0, "epsilon": 0.1, "tol": 1e-3},
    "boosting": {"kind": "boosting", "trees": 5, "leaves": 7, "learning_rate": 0.1, "min_rows": 10},
    "law": {"kind": "linear_law", "window_hours": 24, "terms": ["v", "v*cd_past", "l_arc", "v_arc*cd_arc"]},
}


def orbits(gm):
    """States (4, 6) on an equatorial circle, a quarter of a turn apart: radial x, y, -x, -y."""
    radius, speed = 7e6, np.sqrt(gm / 7e6)
    return np.array(
        [[radius, 0, 0, 0, speed, 0], [0, radius, 0, -speed, 0, 0]]
        * 2
        * np.array([[1.0], [1.0], [-1.0], [-1.0]])
    )


@pytest.fixture
def four():
    """Estimates at four tracks of two measurements, the third not converged, and predictions of others."""
    t = np.array([0.0, 0.1, 0.2, 0.9]) * DAY
    estimates = pd.DataFrame({"track": range(4), "t": t, "converged": [True, True, False, True]})
    estimates[STATE] = orbits(3.986e14)
    covariance = np.diag([9.0, 4.0, 1.0, 9e-6, 4e-6, 1e-6, 0.01])[np.tril_indices(7)]
    estimates.loc[2, STATE] = 1e300  # no orbit: must neither warn nor spread
    estimates[PARAMETER_COVARIANCES] = np.tile(covariance, (4, 1))
    estimates["reason"] = ["", "", "not converged", ""]
    tracks = pd.DataFrame({"track": np.repeat(range(4), 2), "t": np.repeat(t, 2) + np.tile([0.0, 60.0], 4)})
    pairs = [(0, 1), (0, 2), (0, 3), (1, 3)]
    i, j = np.array(pairs).T
    predictions = pd.DataFrame({"i": i, "j": j, "reason": ["", "", "", "decayed"]})
    moved = np.array([10.0, 20.0, 30.0, 0.1, 0.2, 0.3])  # along the axes of GCRF
    predictions[STATE] = orbits(3.986e14)[j] + moved
    predictions.loc[3, STATE] = np.nan
    return predictions, estimates, tracks


def test_error_and_uncertainty_are_in_rsw_of_the_later_estimate(four):
    found = labels.build(*four)
    assert found.columns.tolist() == SCHEMAS["labels"].names
    # At track 1 the radial axis is y and the along-track one is -x, at track 3 -y and x.
    np.testing.assert_allclose(found.loc[0, list(COMPONENTS)].tolist(), [20, -10, 30, 0.2, -0.1, 0.3])
    np.testing.assert_allclose(found.loc[2, list(COMPONENTS)].tolist(), [-20, 10, 30, -0.2, 0.1, 0.3])
    np.testing.assert_allclose(found.loc[0, SIGMAS].tolist(), [2.0, 3.0, 1.0, 2e-3, 3e-3, 1e-3])


def test_a_pair_without_prediction_or_later_estimate_says_why(four):
    found = labels.build(*four)
    assert found["reason"].tolist() == ["", "later estimate: not converged", "", "decayed"]
    assert found.loc[[1, 3], [*COMPONENTS, *SIGMAS]].isna().all(axis=None)
    predictions, estimates, tracks = four
    lost = labels.build(predictions, estimates[estimates["track"] != 1], tracks)
    assert lost.loc[0, "reason"] == "later estimate: none"


def test_a_label_is_known_when_its_last_track_is_over(four):
    assert (labels.build(*four)["t_known"] / DAY * 1440).round(6).tolist() == [145, 289, 1297, 1297]


def test_typical_labels_weigh_one_and_useless_ones_nothing():
    assert inverse_variances(np.array([0.0, 10.0, 1e9])).round(6).tolist() == [2.0, 1.0, 0.0]
    assert inverse_variances(np.zeros(3)).tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize("name", LEARNERS)
def test_equal_weights_change_nothing_and_useless_rows_no_model(name):
    rng = np.random.default_rng(3)
    variables = ["a", "b"]
    terms = {"terms": variables} if name == "law" else {}
    settings = learners.of_job({**LEARNERS[name], **terms, "variables": variables})
    x, noise = rng.normal(size=(200, len(variables))), rng.normal(size=200)
    y = x.sum(axis=1) + 0.1 * noise

    def predicted(y, weights):
        return learners.fit(Training(x, y, variables, seed=1, weights=weights), settings).predict(x)

    if name == "law":  # scikit-learn's sums differ with weights of one
        np.testing.assert_array_equal(predicted(y, np.ones(200)), predicted(y, None))
    useless = np.arange(200) % 5 < 3
    wrong = 5.0 * y if name == "law" else y + 50.0  # a law has no intercept
    spoilt, weights = np.where(useless, wrong, y), np.where(useless, 1e-9, 1.0)
    weighted, unweighted = predicted(spoilt, weights), predicted(spoilt, None)
    assert np.abs(weighted - y)[~useless].mean() < 0.2 * np.abs(unweighted - y)[~useless].mean()


@pytest.fixture(scope="module")
def orbit(truth_model, iss):
    return truth.simulate(Propagator(truth_model, iss), duration=1.7 * DAY, step=20.0)


@pytest.fixture(scope="module")
def chain(assumed_model, orbit, earth_orientation, three_stations, iss):
    """From tracks to datasets by label: what the workflow does without a truth."""
    propagator = Propagator(assumed_model, iss)

    def estimated(tracks, **settings):
        settings = SETTINGS.evolve(cd_bounds=None, **settings)
        starts = start_states.perturbed(orbit, tracks, rso="iss", settings=settings, seed=42)
        measured = observations.Measured(tracks, earth_orientation, three_stations)
        return quarantine.estimate_all(propagator, starts, measured, settings=settings)

    def predicted(estimates):
        return prediction.predict_all(propagator, orbit, estimates, max_days=0.5)

    def chained(tracks):
        short, long = estimated(tracks), estimated(tracks, window_hours=24)
        pairs = predicted(short)
        beside = (
            sensitivity.sensitivities(propagator, short, pairs),
            other_windows.build_arcs(propagator, pairs, arc_estimates=long, arc_predictions=predicted(long)),
            other_windows.build_past(pairs, arc_estimates=long, apriori=iss.cd, memory_days=30),
        )
        known = labels.build(pairs, short, tracks)
        table = dataset.build(short, pairs, tracks, gm=assumed_model.gm, cleaning=CLEANING, labels=known)
        for other in beside:
            table = dataset.join_table(table, other)
        return table

    return chained


@pytest.fixture(scope="module")
def known(chain, rows):
    return chain(rows)


@pytest.fixture(scope="module")
def moved(chain, rows):
    """The same, where all that was measured after the end of the training is 10 km off."""
    late = rows["t"] > END_OF_TRAINING
    return chain(rows.assign(range=rows["range"].mask(late, rows["range"] + 1e4)))


def models(table, folder):
    """The bytes of every model's file."""
    chosen = table[splits.training_rows(table, TRAIN, span_days=[0, 1], seed=1)]
    found = {}
    for name, given in LEARNERS.items():
        settings = learners.settings_of(given).resolved(component="e_y", variables=LEARNING_VARIABLES)
        weights, described = learners.train(chosen, component="e_y", settings=settings, seed=1).to_table()
        write_table(folder / name, weights, learners.schema(described), metadata=described)
        found[name] = (folder / name).read_bytes()
    return found


def test_what_is_measured_after_the_training_changes_no_byte_of_a_model(known, moved, tmp_path):
    assert models(known, tmp_path) == models(moved, tmp_path)


def test_what_is_measured_later_would_show_if_it_were_used(known, moved):
    after = known["t_known"] > END_OF_TRAINING
    assert not after[splits.training_rows(known, TRAIN, span_days=[0, 1], seed=1)].any()
    shift = np.abs(known["e_y"] - moved["e_y"])
    assert shift[after].median() > 100.0
    assert shift[~after].max() == 0.0


def test_labels_stand_for_the_truth(known):
    kept = known[known["keep"]]
    assert set(known.columns) >= set(SCHEMAS["labelled"].names)
    assert kept[["e_y", "sigma_e_y", "t_known"]].notna().all(axis=None)
    assert (kept["t_known"] > kept["t_j"]).all()
