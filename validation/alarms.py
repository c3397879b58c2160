"""Prints how many alarms public element sets raise per collision and per approach below a kilometre, and what
share of collisions they flag, by height and by the angle at which two objects cross:

    python -m validation.alarms results/catalogue/catalogue/residuals/summer/trees.parquet

Two objects of a band err as they did on the same morning, and radially and cross-track as sets usually do.
Sizes of SGP4's errors are those of the other half of the objects, by band and lead; improved sets have their
own. All once with independent errors, and once with the part by drag that objects share.
"""

import sys
from collections.abc import Iterator

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.seeds import derive
from opml.conjunctions.collision_alarms import Screening, alarms_by_day
from opml.element_sets import corrector
from opml.interop.element_sets import sgp4_errors
from opml.orbits.rsw_covariance import half_width
from opml.tables import read_table

LEADS = (1, 3, 5, 7)
SCREENING = Screening(radius=20.0, threshold=1e-4)
HEIGHTS = {
    "all": range(7),
    "300 to 450 km": range(2),
    "450 to 600 km": range(2, 5),
    "600 to 1000 km": range(5, 7),
}
"""Bands of a catalogue's study."""

LEVEL = 0.9
SEED = 42


def pairs(residuals: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield the errors and sizes in RSW [m] of SGP4 and of improved sets, as `worth` has them."""
    taught = corrector.drawn_halves(residuals["number"].to_numpy(), "alarms", seed=SEED) == 0
    size = residuals[taught].groupby(["band", "lead"])["error"].apply(_sigma).rename("sgp4_sigma")
    judged = residuals[~taught].join(size, on=["band", "lead"])
    for name, error, sigma in (("SGP4", "error", "sgp4_sigma"), ("improved", "improved", "improved_sigma")):
        rows = judged.dropna(subset=[error, sigma])
        days, law = rows["lead"].to_numpy(float), sgp4_errors.law()[rows["band"]]
        across = np.hypot(law[:, [0, 2], 0], days[:, None] * law[:, [0, 2], 1])
        drawn = across * derive(SEED, "alarms", name).standard_normal(across.shape)
        yield (
            name,
            pd.DataFrame(
                {
                    "duration": DAY * days,
                    "morning": rows["morning"].astype(str) + " " + rows["band"].astype(str),
                    "e_x": drawn[:, 0],
                    "e_y": rows[error].to_numpy(),
                    "e_z": drawn[:, 1],
                    "sigma_x": across[:, 0],
                    "sigma_y": rows[sigma].to_numpy(),
                    "sigma_z": across[:, 1],
                }
            ),
        )


def _sigma(errors: pd.Series) -> float:
    return float(errors.abs().quantile(LEVEL) / half_width(LEVEL))


def table(residuals: pd.DataFrame) -> pd.DataFrame:
    """Return alarms per collision and approach, and the share of collisions flagged [%], by case and day."""
    rows = []
    for height, bands in HEIGHTS.items():
        for name, errors in pairs(residuals[residuals["band"].isin(bands)]):
            shared = errors.assign(common=np.sqrt(sgp4_errors.COMMON) * errors["sigma_y"])
            for case, told in ((f"{name}, independent", errors), (f"{name}, shared", shared)):
                found = alarms_by_day(told, SCREENING, days=LEADS, seed=SEED)
                rows.append(found.assign(height=height, case=case, flagged=100.0 * found["flagged"]))
    values = ["alarms", "per_approach", "flagged"]
    return pd.concat(rows).pivot(index=["height", "case", "crossing"], columns="day", values=values)


def main(path: str) -> None:
    """Print the table of a test's residuals."""
    print(table(read_table(path, "catalogue_residuals")).round(2).to_string())


if __name__ == "__main__":
    main(*sys.argv[1:])
