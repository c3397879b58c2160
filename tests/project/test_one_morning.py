"""The picture of one morning: what it says of two predictions, and the ellipse it draws."""

import numpy as np
import pytest

from validation.pictures.one_morning import INSIDE, Places, one_morning

SIGMA = (100.0, 2000.0)


@pytest.fixture
def axes():
    errors = {"SGP4": (50.0, -15_000.0), "opml": (-20.0, 750.0)}
    (axes,) = one_morning([Places(1.0, 7500.0, errors, SIGMA)]).axes
    return axes


def test_errors_are_lengths_and_times(axes):
    texts = [text.get_text() for text in axes.texts]
    assert texts == ["true", "SGP4: \N{MINUS SIGN}15 km, 2 s late", "opml: 750 m, 0.1 s early"]
    title = axes.figure.get_suptitle()
    assert title.startswith(
        "One morning, three orbits: after a week SGP4 is 15 km off along the track, opml 750 m"
    )


def test_the_ellipse_contains_the_share_that_it_states(axes):
    (ellipse,) = axes.patches
    drawn = np.random.default_rng(1).normal(size=(20_000, 2)) * SIGMA[::-1]
    half = np.array([ellipse.get_width(), ellipse.get_height()]) / 2.0
    inside = ((drawn / half) ** 2).sum(axis=1) < 1.0
    assert tuple(ellipse.get_center()) == (750.0, -20.0)
    assert inside.mean() == pytest.approx(INSIDE, abs=0.01)
