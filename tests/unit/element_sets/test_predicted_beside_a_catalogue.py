"""A prediction with a catalogue beside it: the set is that of the whole catalogue, improved together."""

import numpy as np
import pandas as pd
import pytest
import sinking_histories

from opml.element_sets import improve, prediction, trained_model, weighting
from opml.interop.element_sets import known_sets

DATE = "2026-01-08T06:00:00"
NUMBER = 101


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The sets of one object, and a catalogue of eleven others."""
    folder = tmp_path_factory.mktemp("sets")
    sinking_histories.write(folder / "own.tle", [NUMBER], 49)
    (folder / "others").mkdir()
    sinking_histories.write(folder / "others" / "others.tle", range(NUMBER + 1, NUMBER + 12), 49)
    return folder


@pytest.fixture(scope="module", autouse=True)
def learned():
    """Every object gets what the package's model of payloads learned."""
    with pytest.MonkeyPatch.context() as patch:
        numbers = range(NUMBER, NUMBER + 12)
        weights = weighting.sole(pd.Series("learned: payloads", index=numbers))
        patch.setattr(weighting, "weights", lambda rows, tried: weights)
        sinking_histories.seek_coarsely(patch.setattr)
        yield


@pytest.fixture(scope="module")
def beside(folder):
    return prediction.predict(folder / "own.tle", date=DATE, catalogue=[folder / "others"])


def test_the_set_is_that_of_the_whole_catalogue(folder, beside):
    known = improve.read(
        [folder / "own.tle", folder / "others"], date=DATE, weather="OBSERVED", latency=known_sets.LATENCY
    )
    table = improve.improve(known, trained_model.read(None)).table.set_index("number")
    assert len(table) == 12
    assert beside.identity.number == NUMBER
    assert beside.way == "set improved by forecast density and a correction learned from payloads"
    assert (beside.how["motion"], beside.how["bstar"]) == tuple(table.loc[NUMBER, ["motion", "bstar"]])
    assert (beside.past["number"] == NUMBER).all()


def test_others_change_the_set_and_no_later_ones_do(folder, beside, tmp_path):
    alone = prediction.predict(folder / "own.tle", date=DATE)
    assert np.linalg.norm((alone.states(alone.t) - beside.states(beside.t))[-1, :3]) > 1.0
    sinking_histories.write(tmp_path / "others.tle", range(NUMBER + 1, NUMBER + 12), 56)
    later = prediction.predict(folder / "own.tle", date=DATE, catalogue=[tmp_path])
    np.testing.assert_array_equal(later.states(later.t), beside.states(beside.t))
    np.testing.assert_array_equal(later.sigmas(later.t), beside.sigmas(beside.t))
