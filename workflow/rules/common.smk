# Settings, names and helpers that the rules share. Settings are checked here, before there is a DAG.
import os
import sys
import time
from dataclasses import asdict
from pathlib import Path

from opml import experiments, generalisation, naming, tables
from opml.config import load, with_numbers
from opml.environment import coverage
from opml.errors import InputError
from opml.learning import learners
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
    learners.check(config)
except InputError as error:
    # One line, where Snakemake would put its own frame around the message.
    sys.exit(f"opml: {error}")

RESULTS = config["results"]
ENVIRONMENT = {name: f"{RESULTS}/environment/{name}.parquet" for name in tables.ENVIRONMENT}
# The atmosphere that the RSO flies through may see another Sun than the assumed model's.
TRUE_ACTIVITY = "true_solar_activity" if "true_solar_activity" in config["environment"] else "solar_activity"
TRUE_ENVIRONMENT = ENVIRONMENT | {"solar_activity": f"{RESULTS}/environment/{TRUE_ACTIVITY}.parquet"}
TRAINED_ON = f"(?:{rso_pattern(SETTINGS.rsos)}|{naming.pool_pattern(config['pools'], SETTINGS.rsos)})"


SEED = config["seed"]
NOISE = naming.seed_pattern(naming.NOISE, default=SEED["noise"])
WINDOW = naming.window_pattern(default=config["estimation"]["window_hours"])
SPLIT = naming.seed_pattern(naming.SPLIT, default=SEED["split"])


wildcard_constraints:
    rso=rso_pattern(SETTINGS.rsos),
    target=rso_pattern(SETTINGS.rsos),
    stations=stations_pattern(SETTINGS.stations) + NOISE,
    window=f"(?:{WINDOW}|{naming.PERFECT})",
    reading=f"(?:{naming.other_reading(config['cleaning']['previous'])})?",
    train=f"(?:{TRAIN}){SPLIT}",
    test=TEST,
    learner=naming.learner_pattern(config["learners"]),
    component="|".join(tables.COMPONENTS),
    evaluation="|".join(config["experiments"]["evaluations"]),


def code(script):
    """Digest of the modules of opml that a script uses: as a param, it reruns the rule when one of them changes."""
    return script_digest(WORKFLOW / "scripts" / script)


def source(name):
    """The user's own file behind a table of the environment, if a setting gives one; no storage takes it."""
    path = config["environment"][name]
    return local(path) if Path(path).suffix else []


def sound(*functions):
    """Input function without files: a name that asks for what cannot be ends the plan in one line."""

    def check(wildcards):
        try:
            for function in functions:
                function(wildcards)
        except InputError as error:
            sys.exit(f"opml: {error}")
        return []

    return check


def settle(folder):
    """Date tables of tomorrow now: after a clock was set back, Snakemake would refuse what is made from them as older."""
    now = time.time()
    for path in Path(folder).rglob("[!.]*.parquet"):
        if path.stat().st_mtime > now:
            os.utime(path, (now, now))


def rso(wildcards):
    """The RSO that a file name asks for, varied as its name says."""
    return asdict(parse_rso(wildcards.rso, SETTINGS.rsos))


def stations(wildcards):
    """The stations that a file name asks for."""
    names, _ = naming.parse_seed(wildcards.stations, naming.NOISE, default=SEED["noise"])
    return [asdict(station) for station in parse_stations(names, SETTINGS.stations)]


def noise_seed(wildcards):
    """The seed of the measurement noise that a file name asks for."""
    return naming.parse_seed(wildcards.stations, naming.NOISE, default=SEED["noise"])[1]


def window_hours(wildcards):
    """The hours of tracks that an estimate is made of, as a file name asks for."""
    return naming.parse_window(wildcards.window, default=config["estimation"]["window_hours"])


def split(wildcards):
    """The training split that a file name asks for, and its seed."""
    train, seed = naming.parse_seed(wildcards.train, naming.SPLIT, default=SEED["split"])
    naming.check_split(train, duration_days=config["duration_days"])
    return {"train": train, "seed": seed}


def cleaning(wildcards):
    """The settings of the cleaning, with the reading of t_b that a file name asks for."""
    previous = naming.parse_reading(wildcards.reading, previous=config["cleaning"]["previous"])
    return config["cleaning"] | {"previous": previous}


def learner(wildcards):
    """The learner that a file name asks for, and the variables it learns from."""
    return learners.resolved(
        naming.parse_learner(wildcards.learner, config["learners"]),
        component=wildcards.component,
        variables=config["learning"]["variables"],
    )


def beside(part):
    """Input function: tables beside the dataset of the RSO in a part of the file name, where the learner asks."""

    def find(wildcards):
        asked = set(learner(wildcards)["variables"])
        oracle = {name for name in asked if name in tables.SCHEMAS["oracle"].names}
        kinds = {"oracle": oracle, "mechanism": asked - oracle - {*tables.LEARNING_VARIABLES, "gap"}}
        where = f"{wildcards[part]}/{wildcards.stations}{wildcards.window}.parquet"
        return [f"{RESULTS}/{kind}/{where}" for kind, names in kinds.items() if names]

    return find


def experiment(wildcards):
    """What a file name asks for, as the metrics tell it."""
    parts = dict(wildcards.items())
    naming.check_split(parts["test"], duration_days=config["duration_days"])
    trained, target = parts["rso"], parts["target"]
    if parts["test"] == "seen" and trained != target:
        raise InputError(f"split 'seen': expected the RSO that was trained on, {trained}, got {target}")
    parts["stations"] += parts.pop("window") + parts.pop("reading")
    return parts


def made(pattern, **parts):
    """The file of a pattern whose parts are given; not `format`, which would part it from its storage."""
    return pattern.apply_wildcards(parts)


def named(pattern, *found):
    """The files of experiments, each once."""
    return list(dict.fromkeys(made(pattern, **experiment.names()) for experiment in found))


def over(window, pattern):
    """Input function: the file of a pattern, of estimates over that window."""
    return lambda wildcards: made(pattern, **dict(wildcards.items()) | {"window": window})


def published(found):
    """The paper's P_ML of experiments, where it gives one."""
    numbers = {key: generalisation.published(config, one) for key, one in found.items()}
    return [[*key, number] for key, number in numbers.items() if number is not None]


def figures(*names, section, caption=None):
    """The outputs of drawing figures, each as PDF and as PNG with a place in the report.

    A figure's caption has its name, unless one caption serves several.
    """
    shown = [shown_in_report(f"figs/{name}", ".png", section, caption) for name in names]
    return {"pdf": [f"{RESULTS}/figs/{name}.pdf" for name in names], "png": shown}


def documents(*names, section, caption=None):
    """The outputs of a table: Markdown, tab-separated text, and HTML with a place in the report."""
    outputs = {kind: [f"{RESULTS}/{name}.{kind}" for name in names] for kind in ("md", "tsv")}
    return outputs | {"html": [shown_in_report(name, ".html", section, caption) for name in names]}


def shown_in_report(name, suffix, section, caption=None):
    """An output with its place in the report: under the paper's section, with a caption that says what to see."""
    title = Path(name).name
    caption = f"../report/{caption or title}.rst"
    return report(f"{RESULTS}/{name}{suffix}", caption=caption, category=section, labels={"shows": title})
