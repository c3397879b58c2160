"""The figure of when learning helps: shares by groups of a quantity, a line per test and way."""

import numpy as np
import pandas as pd

from opml.figures.catalogue.gains import gains

OBJECTS, MORNINGS = 60, 8


def tables():
    """Errors of a kilometre, of which the learned prediction leaves the more the higher an object is."""
    number = np.repeat(np.arange(OBJECTS), MORNINGS)
    keys = pd.DataFrame(
        {"number": number, "morning": np.tile(np.arange(MORNINGS) + 61000.25, OBJECTS), "lead": 3}
    )
    # Object k has a set on all mornings but those from the eighth on.
    kept = keys["morning"] < 61008.25 - number % 4
    part = number / OBJECTS
    residuals = keys.assign(error=1000.0, scaled=800.0, learned=-1000.0 * part)[kept]
    other = residuals.assign(lead=7, learned=1e9)
    rows = keys.assign(height=4e5 + 1e3 * number, drag=np.log(1e3 + number))
    return pd.concat([residuals, other]), pd.concat([rows, rows.assign(lead=7)])


def test_shares_are_by_groups_of_each_quantity_three_days_ahead():
    residuals, rows = tables()
    figure = gains({"summer": residuals}, {"summer": rows}, {"summer": "from May\npayloads"})
    assert "after 3 days is 7 to 90 % of SGP4's" in figure.get_suptitle()
    assert [axes.get_xlabel() for axes in figure.axes] == [
        "height [km]",
        "drag's displacement in 3 days [km]",
        "judged predictions in ten mornings",
    ]
    learned, scaled, *explained = figure.axes[0].lines
    assert learned.get_label() == f"from May, payloads, {OBJECTS} objects"
    assert [line.get_label() for line in explained] == ["density-scaled, not learned", "SGP4"]
    np.testing.assert_allclose(scaled.get_ydata(), 80.0)
    height, share = learned.get_data()
    np.testing.assert_allclose(share, 100.0 * (height - 400.0) / OBJECTS)
    assert len(share) == 6
    judged = figure.axes[2].lines[1].get_xdata()
    assert 10.0 * 5 / 8 <= min(judged) < max(judged) <= 10.0
