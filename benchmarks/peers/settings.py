"""Settings by what a report calls them."""

from benchmarks import case
from opml.dynamics.settings import Integrator


def step_limits(*limits: float) -> dict[str, Integrator]:
    """Return the paper's integrator with steps up to each of these limits [s]."""
    return {f"≤ {limit:g} s": case.paper().integrator.evolve(max_step_s=limit) for limit in limits}


def steps(*lengths: float) -> dict[str, float]:
    """Return steps of these lengths [s]."""
    return {f"{length:g} s": length for length in lengths}


def tolerances(*digits: int) -> dict[str, float]:
    """Return tolerances of one in the last of so many decimal digits."""
    return {f"tolerance 1e-{number}": float(f"1e-{number}") for number in digits}
