"""Names of a run as figures show them."""

import pytest

from opml.figures import display_names
from opml.figures.model_names import describe_model
from opml.learning.models import learners


@pytest.mark.parametrize(
    ("display", "name", "words"),
    [
        (display_names.display_rso, "swarm", "Swarm A"),
        (display_names.display_rso, "hy2a", "HAIYANG 2A"),
        (display_names.display_rso, "iss_i50_a+20", "ISS-based RSO, i = 50 deg, a + 20 km"),
        (display_names.display_rso, "mine_a-5", "mine, a - 5 km"),
        (display_names.display_rso, "each RSO", "each RSO"),
        (display_names.display_stations, "eglin", "one radar (Eglin)"),
        (display_names.display_stations, "eglin-clear-kaena_noise43", "three radars (Eglin, Clear, Kaena)"),
        (display_names.display_stations, "a-b-c-d", "4 radars (A, B, C, D)"),
        (display_names.display_learner, "svr", "the paper's SVR"),
        (display_names.display_learner, "mechanism", "mechanism"),
    ],
)
def test_names_in_words(display, name, words):
    assert display(name) == words


def described(settings):
    return describe_model(learners.settings_of(settings))


def test_models_that_differ_in_memory_alone_are_told_apart():
    words = described({"kind": "running", "window_hours": 24, "memory_days": 3})
    assert words == "fits with the running mean of Cd, 24 h, memory 3 d"


def test_models_of_a_kind_are_told_apart_by_their_settings():
    law = {"kind": "linear_law", "terms": ["duration*duration", "duration*duration*cd"]}
    assert described(law) == "robust linear law, duration², duration² cd"
    assert described(law | {"terms": ["l", "v", "v*cd", "s"]}) == "robust linear law, 4 terms"
    svr = {"kind": "svr", "kernel_scale": 8, "c": 1.0, "epsilon": 0.1, "tol": 1e-3}
    assert described(svr) == "SVR, as in the paper, kernel scale 8"
    assert described(svr | {"kernel_scale": "sigest"}) == "SVR, as in the paper"
