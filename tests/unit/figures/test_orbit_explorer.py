"""The page on which one turns an orbit and picks an estimate, as text and in a real browser."""

import html
import json
import re
import sys

import numpy as np
import pandas as pd
import pytest
from browser import opened
from support import EARTH, RADAR

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures import orbit_explorer
from opml.figures.ground_tracks import ObservedOrbit

ESTIMATES, LATER = 5, 12

# What a visitor does: move the slider to the last estimate, then look at the errors that are drawn.
VISIT = """<script>
window.addEventListener("load", async () => {
  const page = document.getElementById("explore");
  const steps = page.layout.sliders[0].steps;
  const step = steps[steps.length - 1];
  await Plotly[step.method](page, ...step.args);
  const seen = page.data.filter(trace => trace.type === "scatter").map(trace => trace.y);
  document.body.setAttribute("data-globes", page.querySelectorAll(".gl-container canvas").length);
  document.body.setAttribute("data-seen", JSON.stringify(seen));
});
</script></body>"""


@pytest.fixture
def tables():
    """An orbit about the poles, and two models on predictions from five estimates."""
    t = np.arange(0.0, 3 * DAY, 60.0)
    angle = 2 * np.pi * t / 5700.0
    truth = pd.DataFrame({"t": t, "x": 6.8e6 * np.cos(angle), "y": 0.0, "z": 6.8e6 * np.sin(angle)})
    pairs = [(i, k) for i in range(ESTIMATES) for k in range(1, LATER + 1)]
    rows = pd.DataFrame(pairs, columns=["i", "k"])
    true = 100.0 * (1 + rows["i"]) * rows["k"]
    evaluation = pd.DataFrame({"i": rows["i"], "duration": 0.1 * DAY * rows["k"], "true": true})
    models = {
        "law": evaluation.assign(residual=-0.1 * true),
        "svr": evaluation.assign(residual=2.0 * true),
    }
    dataset = pd.DataFrame({"i": range(ESTIMATES), "t_i": 0.3 * DAY * np.arange(ESTIMATES)})
    return ObservedOrbit(truth, EARTH, [RADAR]), models, dataset


def page(tables):
    pytest.importorskip("plotly", reason="plotly comes with the extra `explore`")
    return orbit_explorer.page(
        *tables, component="e_y", epoch="2019-09-03T00:00:00", back="study.html", note="iss by radar"
    )


def test_what_changes_with_the_estimate(tables):
    orbit, models, _ = tables
    path, start, before, law, svr = orbit_explorer._moving_traces(2, 0.6 * DAY, models, orbit)
    assert (len(path["x"]), len(start["x"])) == (96, 1)
    assert np.hypot(np.hypot(path["x"], path["y"]), path["z"]) == pytest.approx(6800.0, abs=0.2)
    assert before["x"] == pytest.approx(0.1 * np.arange(1, LATER + 1))
    assert before["y"] == pytest.approx(300.0 * np.arange(1, LATER + 1))
    assert law["y"] == pytest.approx(30.0 * np.arange(1, LATER + 1))
    assert svr["y"] == pytest.approx(600.0 * np.arange(1, LATER + 1))


def test_the_page_leads_back(tables):
    assert '<body><a href="study.html"' in page(tables)


def test_estimates_with_few_predictions_are_not_offered(tables):
    _, models, dataset = tables
    few = models["law"][(models["law"]["i"] != 3) | (models["law"]["duration"] < 0.35 * DAY)]
    assert orbit_explorer._picks(few, dataset)["i"].tolist() == [0, 1, 2, 4]


def test_the_page_needs_nothing_else_and_is_the_same_each_time(tables):
    text = page(tables)
    assert text == page(tables)
    assert "iss by radar" in text
    assert '<html lang="en">' in text
    assert '<meta name="viewport" content="width=device-width' in text[:200]
    assert "<title>iss by radar</title>" in text
    assert "iss by radar\\u003cbr\\u003eTurn the orbit" in text
    assert '"100 m","1 km"' in text
    assert "0.60, 2019-09-03 14:24 UTC" in text  # the estimate in the middle
    assert '"active":2' in text
    assert not re.search(r'<(?:script|link)[^>]+(?:src|href)="http', text)


def test_no_two_models_look_alike():
    names = [f"m{k}" for k in range(20)]
    *_, lines = (orbit_explorer._looks(names)[-20:],)
    assert len({(line["line"]["color"], line["line"]["dash"]) for line in lines}) == 20


def test_without_a_model(tables):
    with pytest.raises(InputError, match="at least one model"):
        orbit_explorer.page(
            tables[0], {}, tables[2], component="e_y", epoch="2019-09-03T00:00:00", back="study.html"
        )


def test_without_plotly_it_is_one_line(tables, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.graph_objects", None)
    with pytest.raises(InputError, match="expected the package plotly, which is not installed"):
        orbit_explorer.page(*tables, component="e_y", epoch="2019-09-03T00:00:00", back="study.html")


def test_a_browser_shows_the_errors_of_the_estimate_that_is_picked(tables, tmp_path):
    visited = tmp_path / "explore.html"
    visited.write_text(page(tables).replace("</body>", VISIT))
    shown = opened(visited)
    assert "main-svg" in shown
    assert re.findall(r'data-globes="([^"]*)"', shown) == ["1"]  # drawn in three dimensions
    (seen,) = re.findall(r'data-seen="([^"]*)"', shown)
    before, law, svr = json.loads(html.unescape(seen))
    assert before == pytest.approx(500.0 * np.arange(1, LATER + 1))
    assert law == pytest.approx(50.0 * np.arange(1, LATER + 1))
    assert svr == pytest.approx(1000.0 * np.arange(1, LATER + 1))
    assert "1.20" in shown  # the day of the last estimate, on the slider
