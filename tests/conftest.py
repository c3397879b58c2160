"""Fixtures shared by all tests; `support.py` beside this file holds plain functions for them.

No test may change in place what tests share: `unchanged.py` sees to it; `case_names.py` to names of cases.
"""

import os
import signal

# A shell ignores interrupts for what it starts in the background, and so would all that the tests start.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# As in a job; there are as many processes of tests as cores, and threads that wait for a core keep it busy.
os.environ["OMP_NUM_THREADS"] = "1"  # read where numpy and scikit-learn are loaded
os.environ["OPML_DATA"] = os.devnull  # what the user fetched is no test's
os.environ |= dict.fromkeys(("OPML_CELESTRAK", "OPML_IERS"), "http://127.0.0.1:9")  # where nobody answers

import numpy as np
import pytest
from case_names import pytest_make_parametrize_id  # noqa: F401
from hypothesis import settings

from opml.workflow.host import lend_cache

lend_cache()  # before the kernels look for theirs

from support import ASSUMED_BODIES, environment, force_model, rsos, stations  # noqa: E402
from unchanged import pytest_fixture_setup, shared_values_stay  # noqa: E402, F401

from opml.catalog.propagator import Propagator  # noqa: E402

# Drawn cases are the same in every run, but for `make draws`. A loaded machine may take its time over each.
settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("anew", max_examples=300, derandomize=False, deadline=None, print_blob=True)
settings.load_profile("same")


@pytest.fixture(scope="session")
def earth_orientation():
    """The Earth orientation table of the paper's 50 days."""
    return environment()["earth_orientation"]


@pytest.fixture(scope="session")
def truth_model():
    """A small truth model: every body, the field to degree 12."""
    return force_model(12)


@pytest.fixture(scope="session")
def assumed_model():
    """A smaller model, as the assumed one differs from the true: fewer bodies and a coarser field."""
    return force_model(8, ASSUMED_BODIES)


@pytest.fixture(scope="session")
def kepler_model(assumed_model):
    """A force model of the central term, drag and radiation pressure; without the latter two, Kepler's."""
    return assumed_model._replace(
        weights=np.zeros_like(assumed_model.weights), gms=np.zeros_like(assumed_model.gms)
    )


@pytest.fixture(scope="session")
def iss():
    """The paper's RSO."""
    return rsos()["iss"]


@pytest.fixture(scope="session")
def propagator(assumed_model, iss):
    """The paper's RSO under the assumed model."""
    return Propagator(assumed_model, iss)


@pytest.fixture(scope="session")
def three_stations():
    """The paper's stations, in the sheet's order."""
    return list(stations().values())
