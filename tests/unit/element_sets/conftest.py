"""An orbit under small forces that a publisher makes sets of."""

import pytest
from publisher import small_forces, true_orbit


@pytest.fixture(scope="module")
def forces():
    return small_forces()


@pytest.fixture(scope="module")
def truth(forces):
    return true_orbit(forces)
