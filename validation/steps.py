"""What the steps of the paper's integrator do to the prediction errors that are learned."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.predict.mechanism import usable
from opml.catalog.predict.prediction import predict_all
from opml.catalog.propagator import Propagator
from opml.catalog.simulate.observing import QUANTITIES
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import Integrator
from validation import estimation
from validation.case import Case

FINE = Integrator(position_tolerance_m=1e-6, min_step_s=1e-4, max_step_s=10.0)
"""A ninth of the paper's longest step."""


def effect(case: Case, models: Mapping[str, ForceModel], earth_orientation: pd.DataFrame) -> pd.DataFrame:
    """Return along-track errors [m] of the same predictions of RSO, at the paper's steps and at FINE.

    Truth, estimation and prediction all fly at one or the other; the noise is the same. Columns days
    (length), paper, fine.
    """
    flown = {}
    for name, integrator in {"paper": case.integrator, "fine": FINE}.items():
        truth, measured = estimation.simulated(case, models["truth"], earth_orientation, integrator)
        flown[name] = truth, measured, integrator
    coarse = flown["paper"][1]
    pairs = [
        _errors(
            case, models["assumed"], truth, _with_noise_of(coarse, measured), earth_orientation, integrator
        )
        for truth, measured, integrator in flown.values()
    ]
    both = pairs[0].merge(pairs[1], on=["i", "j", "days"], suffixes=("", "_fine"))
    return both.rename(columns={"e_y": "paper", "e_y_fine": "fine"})[["days", "paper", "fine"]]


def share(effect: pd.DataFrame) -> float:
    """Return what the steps change of the errors [%], measured as P_ML measures what learning leaves."""
    return 100.0 * np.abs(effect["fine"] - effect["paper"]).sum() / np.abs(effect["paper"]).sum()


def _with_noise_of(noisy, measured):
    """Return measurements that both tables hold: true values of `measured`, noise and tracks of `noisy`."""
    both = measured.merge(noisy, on=["t", "station"], suffixes=("", "_noisy"), validate="one_to_one")
    for name in QUANTITIES:
        both[name] = both[f"{name}_true"] + (both[f"{name}_noisy"] - both[f"{name}_true_noisy"])
    return both.assign(track=both["track_noisy"])[measured.columns]


def _errors(case, assumed, truth, measured, earth_orientation, integrator):
    estimates = estimation.opmls(case, assumed, truth, measured, earth_orientation, integrator)
    kept = estimates[usable(estimates, case.estimation.cd_bounds)]
    propagator = Propagator(assumed, case.rsos[estimation.RSO], integrator)
    pairs = predict_all(propagator, truth, kept, max_days=case.values["prediction"]["max_days"])
    reached = pairs[pairs["reason"] == ""]
    return reached[["i", "j", "e_y"]].assign(days=(reached["t_j"] - reached["t_i"]) / DAY)
