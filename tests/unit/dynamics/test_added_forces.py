"""A force is a name in a list: a kernel, what it needs of time, and a word in the settings."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from support import REPOSITORY, refusal

from opml.base.provenance import script_digest
from opml.dynamics import settings
from opml.dynamics.kernels import added_forces
from opml.dynamics.settings import ForceModelSettings

TOY = REPOSITORY / "tests" / "toy_force.py"
MODEL = {"degree": 0, "order": 0, "third_bodies": []}


@pytest.fixture(scope="module")
def flown():
    """Where orbits end with the toy force; its machine code has a folder of its own in the cache."""
    digest = hashlib.sha256(script_digest(TOY).encode() + TOY.read_bytes()).hexdigest()
    cache = Path(numba.config.CACHE_DIR) / f"toy-force-{digest[:16]}"
    done = subprocess.run(
        [sys.executable, str(TOY)],
        env={**os.environ, "OPML_CACHE": str(cache)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return {name: np.array(state) for name, state in json.loads(done.stdout).items()}


@pytest.mark.parametrize("others", ["", " beside relativity"])
def test_a_force_that_is_declared_is_flown_under(flown, others):
    moved = flown[f"added{others}"][:3] - flown["left out"][:3]
    assert np.linalg.norm(moved) > 100.0
    np.testing.assert_allclose(flown[f"added{others}"], flown[f"in the mass{others}"], rtol=0.0, atol=1e-3)


def test_every_force_has_its_words_and_its_kernel_or_tides():
    assert {*settings.FORCES} == {"solid_tides", *added_forces.FORCES}


@pytest.mark.parametrize(
    ("forces", "expected"),
    [(["ocean_tides"], "'solid_tides' or 'relativity'"), (["relativity"] * 2, "no item twice")],
)
def test_a_force_that_nobody_declared_is_refused(forces, expected):
    assert expected in refusal(ForceModelSettings.read, MODEL | {"forces": forces}, "force_model")
