"""The paper's tables of models, stations and RSOs as they ran."""

import math
from collections.abc import Iterator, Mapping, Sequence

from opml.dynamics.settings import FORCES, ForceModels
from opml.environment.settings import EnvironmentSettings
from opml.learning.models import learners
from opml.learning.models.contract import LearnerSettings
from opml.orbits.sheets import Rso, Station
from opml.report import texts
from opml.report.document import Block, Table
from opml.report.results import NO_VALUE


def models(environment: EnvironmentSettings, models: ForceModels) -> list[Block]:
    """Return a document on the truth and the assumed model."""
    return [*texts.blocks("settings_tables.models"), force_models(environment, models)]


def learner_table(models: Mapping[str, LearnerSettings]) -> Iterator[Block]:
    """Yield a section on the kind and the terms of each learner; models: settings by name."""
    rows = [
        [
            f"`{name}`",
            learners.description(settings.kind),
            " ".join(f"`{term}`" for term in settings.get("terms") or []) or NO_VALUE,
        ]
        for name, settings in models.items()
    ]
    return texts.blocks("settings_tables.learners", rows)


def force_models(environment: EnvironmentSettings, models: ForceModels) -> Table:
    """Return the table of the truth and the assumed model, side by side."""
    both = models.truth, models.assumed
    assumed = environment.solar_activity
    truth = environment.true_solar_activity or assumed
    percentile = f", percentile {environment.percentile}"
    rows = [
        ["Earth's shape", "WGS84", "WGS84"],
        ["gravity field", *(f"{environment.gravity_field} {m.degree}x{m.order}" for m in both)],
        ["third bodies", *(", ".join(m.third_bodies) for m in both)],
        ["ephemerides", "DE440", "DE440"],
        ["atmosphere", "DTM2000", "DTM2000"],
        ["solar activity", truth + percentile, assumed + percentile + _knowledge(environment)],
        ["radiation pressure", *["sphere, umbra and penumbra"] * 2],
        *[
            [words, *("yes" if force in model.forces else "no" for model in both)]
            for force, words in FORCES.items()
            if any(force in model.forces for model in both)
        ],
        ["drag coefficient", "the RSO's", "estimated"],
    ]
    return Table(["parameter", "truth model", "assumed model"], rows)


def assumed_model(environment: EnvironmentSettings, models: ForceModels) -> Table:
    """Return the table of the assumed model alone, for a run that simulates no truth."""
    both = force_models(environment, models)
    return Table([both.header[0], both.header[2]], [[row[0], row[2]] for row in both.rows])


def weather(environment: EnvironmentSettings) -> str:
    """Return as a sentence what fits and predictions know of the space weather."""
    source = environment.solar_activity
    match environment.knowledge:
        case "forecast":
            return (
                f"Space weather ({source}) as measured up to each estimate, then forecast "
                f"every {environment.issue_hours} h."
            )
        case "hindcast":
            return f"Space weather ({source}) as measured up to the time predicted to: a hindcast."
        case "monthly":
            return f"Space weather: monthly figures ({source})."
    if source == "MSAFE":
        return "Space weather: MSAFE's monthly figures, which were published half a year later."
    return f"Space weather: {source} as in the file, with measured values of the days predicted to."


def _knowledge(environment: EnvironmentSettings) -> str:
    """Return as the end of a cell what the assumed model knows of the activity; empty without a setting."""
    match environment.knowledge:
        case "hindcast":
            return ", as known at each time"
        case "forecast":
            return f", as known at each estimate, then forecast every {environment.issue_hours} h"
    return ""


def stations(sheet: Sequence[Station]) -> list[Block]:
    """Return a document on the stations in the units of the paper's table, but maximum ranges in km."""
    rows = [
        ["latitude [deg]", *(_deg(station.latitude) for station in sheet)],
        ["longitude [deg]", *(_deg(station.longitude) for station in sheet)],
        ["altitude [m]", *(_number(station.altitude) for station in sheet)],
        ["maximum range [km]", *(_number(station.max_range / 1e3) for station in sheet)],
        [
            "feasible elevation [deg]",
            *(f"{_deg(station.min_elevation)} to {_deg(station.max_elevation)}" for station in sheet),
        ],
        *_sigmas(sheet),
    ]
    names = texts.across(station.name for station in sheet)
    return list(texts.blocks("settings_tables.stations", rows, names=names))


def _sigmas(sheet: Sequence[Station]) -> Iterator[list[str]]:
    """Yield a row for each observable that any station measures, a dash where one does not."""
    for name, unit, cell in (
        ("range", "m", _number),
        ("azimuth", "deg", _deg),
        ("elevation", "deg", _deg),
        ("range_rate", "m/s", _number),
        ("right_ascension", "deg", _deg),
        ("declination", "deg", _deg),
    ):
        values = [station.row.get(f"sigma_{name}") for station in sheet]
        if any(value is not None for value in values):
            cells = ("-" if value is None else cell(value) for value in values)
            yield [f"sigma of {name.replace('_', ' ')} [{unit}]", *cells]


def rsos(sheet: Sequence[Rso], *, epoch: str, title: str) -> list[Block]:
    """Return a document on RSOs: osculating elements in GCRF at the epoch [UTC], and bodies."""
    rows = [
        ["semi-major axis [km]", *(_number(rso.a / 1e3) for rso in sheet)],
        ["eccentricity", *(_number(rso.e) for rso in sheet)],
        ["inclination [deg]", *(_deg(rso.i) for rso in sheet)],
        ["argument of perigee [deg]", *(_deg(rso.argp) for rso in sheet)],
        ["RAAN [deg]", *(_deg(rso.raan) for rso in sheet)],
        ["mean anomaly [deg]", *(_deg(rso.mean_anomaly) for rso in sheet)],
        ["area-to-mass ratio [m2/kg]", *(_number(rso.area_to_mass) for rso in sheet)],
        ["drag coefficient", *(_number(rso.cd) for rso in sheet)],
        ["reflection coefficient", *(_number(rso.cr) for rso in sheet)],
    ]
    names = texts.across(rso.name for rso in sheet)
    return list(texts.blocks("settings_tables.rsos", rows, title=title, epoch=epoch, names=names))


def _deg(radians: float) -> str:
    return _number(math.degrees(radians))


def _number(value: float) -> str:
    return f"{value:.10g}"
