# Settings, names and helpers that the rules share. Settings are checked here, before there is a DAG.
import os
import sys
from dataclasses import asdict
from pathlib import Path

from opml import tables
from opml.config import load, with_numbers
from opml.environment import coverage
from opml.errors import InputError
from opml.learning.splits import TEST, TRAIN
from opml.provenance import script_digest
from opml.sheets import parse_rso, parse_stations, rso_pattern, stations_pattern
from snakemake.utils import update_config

WORKFLOW = Path(str(workflow.current_basedir)).parent

# Files given on the command line are laid over the one that the Snakefile names.
GIVEN = [os.path.relpath(path) for path in workflow.config_settings.configfiles]
update_config(config, with_numbers(workflow.config_settings.config))
try:
    SETTINGS = load(
        config,
        schema=WORKFLOW / "schemas" / "config.schema.yaml",
        files=["config/config.yaml", *GIVEN],
    )
    coverage.check(config)
except InputError as error:
    # One line, where Snakemake would put its own frame around the message.
    sys.exit(f"opml: {error}")

RESULTS = config["results"]
ENVIRONMENT = {name: f"{RESULTS}/environment/{name}.parquet" for name in tables.ENVIRONMENT}


wildcard_constraints:
    rso=rso_pattern(SETTINGS.rsos),
    target=rso_pattern(SETTINGS.rsos),
    stations=stations_pattern(SETTINGS.stations),
    train=TRAIN,
    test=TEST,
    learner="|".join(config["learners"]),
    component="|".join(tables.COMPONENTS),


def code(script):
    """Digest of the modules of opml that a script uses: as a param, it reruns the rule when one of them changes."""
    return script_digest(WORKFLOW / "scripts" / script)


def source(name):
    """The user's own file behind a table of the environment, if a setting gives one."""
    path = config["environment"][name]
    return path if Path(path).suffix else []


def rso(wildcards):
    """The RSO that a file name asks for, varied as its name says."""
    return asdict(parse_rso(wildcards.rso, SETTINGS.rsos))


def stations(wildcards):
    """The stations that a file name asks for."""
    return [asdict(station) for station in parse_stations(wildcards.stations, SETTINGS.stations)]
