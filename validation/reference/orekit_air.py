"""Have Orekit tell what air does to ranges and elevations at the paper's stations:

    python -m validation.reference.orekit_air <Orekit's data>

Delays are Saastamoinen's to the zenith, in a standard atmosphere, by Niell's mapping functions; refraction is
Saemundsson's for light and that of ITU-R P.834 for radio waves. Needs the extra `verify`.
"""

import sys
from pathlib import Path

import jpype
import numpy as np
import pandas as pd

from opml.catalog.fit.refraction import standard
from opml.orbits.sheets import read_stations
from validation import orekit
from validation.case import ROOT
from validation.orekit import org
from validation.tables import write_noted

EPOCH = "2016-09-28T12:09:45"
ELEVATIONS = 3.0, 5.0, 10.0, 20.0, 45.0, 80.0


def values(models, station, elevation):
    """Delay of a range [m], refraction [rad] of light and radio, at an elevation [rad] of a straight line."""
    earth, air = org.orekit.models.earth, standard(station.altitude)
    point = org.orekit.bodies.GeodeticPoint(station.latitude, station.longitude, station.altitude)
    weather = earth.weather.PressureTemperatureHumidity(
        station.altitude, air.pressure, air.temperature, air.vapour, float("nan"), float("nan")
    )
    up, seen = (org.orekit.utils.TrackingCoordinates(0.0, angle, 1e6) for angle in (np.pi / 2, elevation))
    provider = earth.weather.ConstantPressureTemperatureHumidityProvider(weather)
    saastamoinen = earth.troposphere.CanonicalSaastamoinenModel(provider)
    zenith = saastamoinen.pathDelay(up, point, jpype.JArray(jpype.JDouble)(0), models.epoch)
    niell = earth.troposphere.NiellMappingFunctionModel(models.utc)
    dry, wet = niell.mappingFactors(seen, point, models.epoch)
    light = earth.EarthStandardAtmosphereRefraction()
    light.setPressure(air.pressure)
    light.setTemperature(air.temperature)
    return {
        "pressure": air.pressure,
        "temperature": air.temperature,
        "vapour": air.vapour,
        "zenith_dry": zenith.getZh(),
        "zenith_wet": zenith.getZw(),
        "delay": zenith.getZh() * dry + zenith.getZw() * wet,
        "bent_light": light.getRefraction(elevation),
        "bent_radio": earth.ITURP834AtmosphericRefraction(station.altitude).getRefraction(elevation),
    }


def main(data):
    orekit.start(orekit.Data.find(data))
    models = orekit.Orekit(EPOCH)
    rows = [
        {"station": station.name, "elevation": elevation} | values(models, station, elevation)
        for station in read_stations(ROOT / "config" / "stations.tsv").values()
        for elevation in np.radians(ELEVATIONS)
    ]
    head = (
        "What air does to ranges and elevations; written by orekit_air.py.",
        f"Orekit {orekit.version()}, SI units, radians.",
    )
    write_noted("orekit_air.csv", pd.DataFrame(rows), *head)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
