"""The picture of the orbit inside a set: what it states is what it draws."""

import numpy as np

from validation.pictures.inside_the_set import inside_the_set


def test_the_headline_has_the_root_mean_squares_that_are_drawn():
    off = {"SGP4": np.tile([100.0, -400.0, 200.0], (9, 1)), "orbit inside": np.tile([2.0, 20.0, 3.0], (9, 1))}
    figure = inside_the_set(off)
    assert figure.get_suptitle().startswith(
        "The same public set: 100 / 400 / 200 m off by SGP4, 2 / 20 / 3 m"
    )
    lines = [[line.get_ydata()[0] for line in axes.lines] for axes in figure.axes]
    assert lines == [[100.0, 2.0], [-400.0, 20.0], [200.0, 3.0]]
    assert [axes.get_ylabel() for axes in figure.axes] == ["radial [m]", "along-track [m]", "cross-track [m]"]
