"""Cut the excerpts of Orekit's tables that the tests read: `python -m validation.reference.excerpt <folder>`.

The full tables, with what they were made of, are described in the README of tests/reference; the columns here
have the project's names and SI units. Run by hand when those tables change.
"""

import sys
from pathlib import Path

import pandas as pd

from validation.case import TABLES

SOURCE = "Orekit 13.1.9, the paper's case; cut by excerpt.py. t [s] from 2016-09-28T12:09:45 UTC, SI units."
STATE = {f"{axis}_m": axis for axis in "xyz"} | {f"v{axis}_mps": f"v{axis}" for axis in "xyz"}
BODIES = ("Sun", "Moon", "Mercury", "Venus", "Mars", "Jupiter", "Saturn", "Uranus", "Neptune", "Pluto")


def points(tables):
    """Accelerations [m/s2] term by term at a dozen states of every kind of orbit, GCRF."""
    full = pd.read_parquet(tables / "points.parquet").iloc[::9]
    cut = full[["rso", "t_s", *STATE]].rename(columns={"t_s": "t"} | STATE)
    for axis in "xyz":
        cut[f"gravity_40_{axis}"] = full[f"grav40_a{axis}_mps2"]
        cut[f"gravity_20_{axis}"] = full[f"grav20_a{axis}_mps2"]
        cut[f"sun_{axis}"] = full[f"tb_Sun_a{axis}_mps2"]
        cut[f"moon_{axis}"] = full[f"tb_Moon_a{axis}_mps2"]
        cut[f"bodies_{axis}"] = sum(full[f"tb_{body}_a{axis}_mps2"] for body in BODIES)
        cut[f"drag_{axis}"] = full[f"drag_a{axis}_mps2"]
        cut[f"pressure_{axis}"] = full[f"srp_a{axis}_mps2"]
    cut["density"] = full["density_kgpm3"]
    cut["altitude"] = full["alt_m"]
    cut["lit"] = full["lighting_ratio"]
    return cut


def shadow(tables):
    """Part of the Sun in sight on the way into and out of the umbra; states and Sun in GCRF."""
    full = pd.read_parquet(tables / "shadow.parquet").iloc[::3]
    return full[["rso", "t_s", "x_m", "y_m", "z_m", "lighting_ratio"]].rename(
        columns={"t_s": "t", "lighting_ratio": "lit"} | STATE
    )


def tracks(tables):
    """Eglin's tracks of the first five days."""
    full = pd.read_csv(tables / "tracks_eglin_50d.csv")
    full = full[full["start_s"] <= 5 * 86400.0]
    return full[["start_s", "end_s", "grid_points"]].rename(
        columns={"start_s": "start", "end_s": "end", "grid_points": "epochs"}
    )


def measurements(tables):
    """Noise-free measurements at whole minutes of the first day, with the true state (GCRF) of the time."""
    full = pd.read_parquet(tables / "measurements_1d_noisefree.parquet")
    orbit = pd.read_parquet(tables / "iss_truth_2d_60s.parquet")
    cut = full.merge(orbit, on="t_s").iloc[::2]
    cut["station"] = cut["station"].str.lower()
    names = {"t_s": "t", "az_rad": "azimuth", "el_rad": "elevation", "range_m": "range"}
    return cut[["station", *names, "x_m", "y_m", "z_m"]].rename(columns=names | STATE)


def trajectory(tables):
    """The true orbit of the paper's RSO, every three hours of two days, GCRF."""
    return (
        pd.read_parquet(tables / "iss_truth_2d_60s.parquet").iloc[::180].rename(columns={"t_s": "t"} | STATE)
    )


def main(tables):
    for cut in (points, shadow, tracks, measurements, trajectory):
        with (TABLES / f"orekit_{cut.__name__}.csv").open("w", encoding="utf-8", newline="\n") as file:
            file.write(f"# {cut.__doc__}\n# {SOURCE}\n")
            cut(tables).to_csv(file, index=False, lineterminator="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
