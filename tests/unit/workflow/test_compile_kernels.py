"""Kernels compiled after installation: those that the jobs of a first figure call."""

import subprocess
import sys

import pytest

# In a process of its own: other tests call the same kernels with arrays of their own kinds.
CALLS = """
import numpy as np
import opml
from opml.dynamics import frames
from opml.dynamics.kernels import block
from opml.learning.models import smo
from opml.learning.models import smo_kernels as svr
from opml.workflow.compile_kernels import compile_kernels

KERNELS = [block.advance, frames._rotations, svr.exponentiate, svr.accumulate, svr.slopes, svr.descend]
compile_kernels()
before = [len(kernel.signatures) for kernel in KERNELS]
environment = opml.make_environment("2016-09-28T12:09:45", days=1)
stations = list(opml.read_stations("config/stations.tsv").values())
iss = opml.read_rsos("config/rsos.tsv")["iss"]
propagator = opml.Propagator(opml.force_model(environment), iss)
truth = opml.propagate(propagator, days=1)
tracks = opml.track(truth, environment, stations, rso=iss)
starts = opml.first_orbit(propagator, tracks, environment, stations)
opml.estimate(propagator, starts, tracks, environment, stations)
x = np.random.default_rng(1).normal(size=(300, 3))
smo.solve(x, x[:, 0], np.ones(300), epsilon=0.01, tol=1e-3)
print(before, [len(kernel.signatures) for kernel in KERNELS])
"""


@pytest.mark.slow
def test_jobs_of_a_first_figure_find_their_kernels_compiled():
    found = subprocess.run([sys.executable, "-c", CALLS], capture_output=True, text=True, check=True)
    assert found.stdout.split("\n")[-2] == "[1, 1, 1, 1, 1, 1] [1, 1, 1, 1, 1, 1]"
