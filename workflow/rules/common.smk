# Settings, names and helpers that the rules share. Settings are checked here, before there is a DAG.
import os
import sys
import time
from dataclasses import asdict
from pathlib import Path

from opml import naming, tables
from opml.orbits import sheets
from opml.environment import knowledge, nrlmsis
from opml.environment.forecasts import methods
from opml.base.errors import InputError
from opml.base.files import PROJECT
from opml.learning.data import components
from opml.learning.models import learners
from opml.learning.models.contract import ARC_MEMORY_DAYS
from opml.base.provenance import script_digest
from opml.report.sections import SECTIONS, section_of
from opml.report.settings_tables import weather
from opml.study import shared_truths
from opml.study.checks import check_data, load
from opml.study.experiments import Study
from opml.study.beyond import Beyond
from opml.study.settings.overlay import COMMAND_LINE, Layer, with_numbers
from opml.study.own_study import Own
from opml.study.paper import Paper
from opml.study.settings.merging import merged


def end(error):
    """End the plan with one line, where Snakemake would put its own frame around the message."""
    sys.exit(f"opml: {error}")


if sum(option in ("--configfile", "--configfiles") for option in sys.argv) > 1:
    end(
        "--configfile: expected all files behind one --configfile, as Snakemake forgets those of an earlier one"
    )
if workflow.modifier.is_main_snakefile():
    # Files given on the command line are laid over the project's, which may be in another folder than this file.
    FILES = ["config/config.yaml", *map(os.path.relpath, workflow.config_settings.configfiles)]
    ON_TOP = Layer(COMMAND_LINE, with_numbers(workflow.config_settings.config))
else:
    # A module: what another workflow hands to it is laid over the settings that come with the package.
    FILES, ON_TOP = [PROJECT / "config" / "config.yaml"], Layer("config", with_numbers(config))
try:
    SOURCE = merged(FILES, ON_TOP)
    SETTINGS = load(SOURCE)
    if workflow.is_main_process:  # each job parses this file anew
        check_data(SOURCE, SETTINGS)
except InputError as error:
    end(error)
# By another name for it, as a module's mapping may be that of the workflow around it.
config = dict(SETTINGS.values)

STUDY = Study(SETTINGS)
PAPER = Paper(STUDY)
BEYOND = Beyond(PAPER)
OWN = Own(STUDY)

RESULTS = config["results"]
ENVIRONMENT = {name: f"{RESULTS}/environment/{name}.parquet" for name in tables.ENVIRONMENT}
# The truth may fly under another solar activity than the assumed model.
TRUE_ACTIVITY = "true_solar_activity" if "true_solar_activity" in config["environment"] else "solar_activity"
TRUE_ENVIRONMENT = ENVIRONMENT | {"solar_activity": f"{RESULTS}/environment/{TRUE_ACTIVITY}.parquet"}
# And through another atmosphere.
ATMOSPHERE = config["force_models"]["truth"].get("atmosphere", "DTM2000")
if ATMOSPHERE == nrlmsis.NAME:
    TRUE_ENVIRONMENT[tables.THERMOSPHERE] = f"{RESULTS}/environment/{tables.THERMOSPHERE}.parquet"
THERMOMETER = config.get("thermometer", {})
CATALOGUE = [*THERMOMETER.get("rsos", []), *THERMOMETER.get("left_out", [])]
# The assumed model may be held to what was known when.
KNOWLEDGE = config["environment"].get("knowledge")
if KNOWLEDGE in knowledge.KNOWN:
    ENVIRONMENT["solar_activity"] = f"{RESULTS}/environment/hindcast.parquet"
FIT_ENVIRONMENT = ENVIRONMENT
if KNOWLEDGE == knowledge.FORECAST:
    # Predictions of a day share an outlook, as arcs under one fly together. A fit uses all that was measured by then.
    OUTLOOKS = f"{RESULTS}/environment/{tables.OUTLOOKS}_{{hours}}h.parquet"
    ENVIRONMENT, FIT_ENVIRONMENT = (
        ENVIRONMENT | {tables.OUTLOOKS: OUTLOOKS.format(hours=hours)}
        for hours in (config["environment"]["issue_hours"], knowledge.FIT_HOURS)
    )
TRAINED_ON = (
    f"(?:{naming.rso_pattern(SETTINGS.rsos)}|{naming.pool_pattern(STUDY.entry('pools'), SETTINGS.rsos)})"
)


# What fits and predictions know of it, as a line of a figure.
WEATHER = weather(config).replace("`", "").rstrip(".")

SEED = config["seed"]
NOISE = naming.seed_pattern(naming.NOISE, default=SEED["noise"])
WINDOW = naming.window_pattern(default=config["estimation"]["window_hours"]) + naming.fitted_pattern(
    convergence=config["estimation"]["convergence"],
    light_time=config["estimation"].get("light_time", False),
)
SPLIT = naming.seed_pattern(naming.SPLIT, default=SEED["split"])
LATER = naming.any_of(filter(None, naming.LABELS.values()))


wildcard_constraints:
    rso=naming.rso_pattern(SETTINGS.rsos),
    target=naming.rso_pattern(SETTINGS.rsos),
    stations=naming.stations_pattern(SETTINGS.stations) + NOISE,
    window=f"(?:{WINDOW}|{naming.PERFECT})",
    arc=naming.ARC,
    reading=f"(?:{naming.other_reading(STUDY.cleaning.previous)})?",
    label=f"(?:{LATER})?",
    train=f"(?:{naming.TRAIN}){SPLIT}",
    test=naming.TEST,
    learner=naming.learner_pattern(config["learners"]),
    component="|".join(tables.COMPONENTS),
    evaluation=naming.any_of(PAPER.evaluations),


def code(script):
    """Digest of the modules of opml that a script uses: as a param, it reruns the rule when one of them changes."""
    return script_digest(workflow.source_path(f"../scripts/{script}"))


def source(name):
    """The user's own file behind a table of the environment, if a setting gives one; no storage takes it."""
    path = config["environment"][name]
    return local(path) if Path(path).suffix else []


def forecast_settings():
    """The settings of the forecast that the assumed model flies under, were it to forecast."""
    return config.get("forecasts", {}).get(config["environment"].get("forecast"), {"kind": "persistence"})


def checked_names(*functions):
    """Input function without files: it ends the plan in one line where a file's name is wrong or impossible."""

    def check(wildcards):
        try:
            for function in functions:
                function(wildcards)
        except InputError as error:
            end(error)
        return []

    return check


def date_back_to_now(folder):
    """Give tables that are dated in the future the present time.

    After a clock was set back, Snakemake would refuse what is made from them, as it would be older.
    """
    now = time.time()
    for path in Path(folder).rglob("[!.]*.parquet"):
        if path.stat().st_mtime > now:
            os.utime(path, (now, now))


def start_without_limit():
    """Lift Snakemake's limit of a hundred jobs a second, which is meant for queues, where jobs run here.

    For it each look at the jobs that are ready brings on another, a second later, and each job that ends one more
    a second, for good: behind five hundred jobs these take half a core (Snakemake 9.27).
    """
    if not workflow.non_local_exec:
        workflow.scheduler.job_rate_limiter = None


def rso(wildcards):
    """The RSO that a file name asks for, varied as its name says."""
    return asdict(sheets.parse_rso(wildcards.rso, SETTINGS.rsos))


def stations(wildcards):
    """The stations that a file name asks for."""
    names, _ = naming.parse_seed(wildcards.stations, naming.NOISE, default=SEED["noise"])
    return [asdict(station) for station in sheets.parse_stations(names, SETTINGS.stations)]


def noise_seed(wildcards):
    """The seed of the measurement noise that a file name asks for."""
    return naming.parse_seed(wildcards.stations, naming.NOISE, default=SEED["noise"])[1]


def window_hours(wildcards):
    """The hours of tracks that an estimate is made of, as a file name asks for."""
    return naming.parse_window(wildcards.window, default=config["estimation"]["window_hours"])


def after_hours(wildcards):
    """The hours of tracks after an estimate, as a setting; none but where a file name asks for both sides."""
    hours = naming.parse_both_sides(wildcards.window)
    return {"after_hours": hours} if hours else {}


def label_window(wildcards):
    """The window of the later estimates that a label is made of."""
    return naming.label_window(wildcards.label, hours=config["estimation"]["window_hours"])


def at_label_window(pattern):
    """Input function: the file of a pattern, of the later estimates that a label is made of."""
    return lambda wildcards: path_of(
        pattern, rso=wildcards.rso, stations=wildcards.stations, window=label_window(wildcards)
    )


def judge(pattern):
    """Input function: the file of true errors beside labels; none where there is no truth, or no label."""

    def find(wildcards):
        target = dict(wildcards.items()).get("target", wildcards.rso)
        base, *_ = naming.rso_parts(target, SETTINGS.rsos)
        if not wildcards.label or base in STUDY.measured:
            return []
        return path_of(pattern, **dict(wildcards.items()) | {"rso": target})

    return find


def split(wildcards):
    """The training split that a file name asks for, and its seed."""
    train, seed = naming.parse_seed(wildcards.train, naming.SPLIT, default=SEED["split"])
    naming.check_split(naming.parse_train(train), duration_days=config["duration_days"])
    return {"train": train, "seed": seed}


def cleaning(wildcards):
    """The settings of the cleaning, with the reading of t_b that a file name asks for."""
    previous = naming.parse_reading(wildcards.reading, previous=STUDY.cleaning.previous)
    return dict(STUDY.entry("cleaning")) | {"previous": previous}


def cd_bounds():
    """Bounds on Cd of the estimates that others start from or are averaged with; null where the study has none."""
    bounds = STUDY.cleaning.cd_bounds
    return None if bounds is None else list(bounds)


def learner(wildcards):
    """The learner that a file name asks for, and the variables it learns from; of e_y where it names none."""
    return learners.resolved(
        naming.parse_learner(wildcards.learner, config["learners"]),
        component=wildcards.get("component", components.CORRECTED),
        variables=config["learning"]["variables"],
    )


def beside(part):
    """Input function: tables beside the dataset of the RSO in a part of the file name, where the learner asks."""

    def find(wildcards):
        settings = learner(wildcards)
        where = f"{wildcards[part]}/{wildcards.stations}{wildcards.window}"
        suffix = {"arcs": naming.arc(*arc)} if (arc := learners.arc_of(settings)) else {}
        return [
            f"{RESULTS}/{kind}/{where}{suffix.get(kind, '')}.parquet"
            for kind in learners.tables_asked(settings["variables"])
        ]

    return find


def trained(wildcards):
    """Input function: the model that a test is asked of, one of its own where its rows standardise it, too."""
    own = wildcards.test.endswith(naming.STANDARDISATIONS["together"])
    return path_of((rules.train_together if own else rules.train).output[0], **dict(wildcards.items()))


def without_truth(wildcards):
    """Raises InputError for a learner that knows what only a simulation does."""
    learners.check_without_truth(wildcards.learner, learner(wildcards))


def fits_over(kind):
    """Input function: the estimates over another window, where the learner asks for a kind of table of them."""

    def find(wildcards):
        settings = learner(wildcards)
        if kind not in learners.tables_asked(settings["variables"]):
            return []
        hours = arc_hours(settings)[0] if kind == "arcs" else config["mechanism"]["long_window_hours"]
        window = naming.windowed(hours, default=config["estimation"]["window_hours"])
        return path_of(
            rules.estimation.output[0], rso=wildcards.rso, stations=wildcards.stations, window=window
        )

    return find


def arc_hours(settings):
    """Window [h] and memory [days] of the arcs that resolved settings of a learner ask for, or none of both."""
    return learners.arc_of(settings) or (0.0, 0.0)


def told_manoeuvres(wildcards):
    """The table whose metadata tell manoeuvres: of an orbit or tracks of one's own; none of a simulated RSO."""
    base, *_ = naming.rso_parts(wildcards.rso, SETTINGS.rsos)
    return known_manoeuvres(wildcards) if base in {*SETTINGS.orbits, *SETTINGS.tracks} else []


def train_days(wildcards):
    """First and last day of the training that a file name asks for; raises InputError where it is no window."""
    train = split(wildcards)["train"]
    parsed = naming.parse_train(train)
    if parsed.kind != "days":
        raise InputError(f"training split '{train}': expected a window of days, such as days-0-20")
    return list(parsed.days)


def futures(wildcards):
    """Input function: the courses that the weather may take, none where it is taken for known."""
    if KNOWLEDGE != knowledge.FORECAST:
        return []
    return path_of(rules.futures.output[0], members=str(config["uncertainty"]["futures"]))


def later_states(wildcards):
    """Input function: the later estimates that labels are made of, none where the truth is known."""
    if not wildcards.label:
        return []
    return at_label_window(rules.estimation.output[0])(wildcards)


def departure_settings(wildcards):
    """What tells which estimates ephemerides may start from, and what flies them."""
    return {
        "epoch": config["epoch"],
        "force_model": config["force_models"]["assumed"],
        "integrator": config["integrator"],
        "rso": rso(wildcards),
        "cleaning": cleaning(wildcards),
        "window_hours": window_hours(wildcards),
        "cd_bounds": cd_bounds(),
        "mechanism": config["mechanism"],
        "arc": [0, 0],
        "max_days": config["prediction"]["max_days"],
    }


def lesson_settings(wildcards):
    """The same, and what a learner is trained anew with each morning."""
    return departure_settings(wildcards) | {
        "arc": arc_hours(learner(wildcards)),
        "learner": learner(wildcards),
        "seed": split(wildcards)["seed"],
        "train_days": train_days(wildcards),
    }


def ephemeris_settings(wildcards):
    """Where ephemerides start, and their grid."""
    return {
        "known_until_days": train_days(wildcards)[1],
        "from": config["ephemeris"]["from"],
        "grid": [
            config["ephemeris"]["step_s"],
            config["prediction"]["max_days"],
            config["duration_days"],
        ],
    }


def mornings_settings(wildcards):
    """What a figure of a study's replayed mornings is told."""
    return {
        "epoch": config["epoch"],
        "learners": list(OWN.mornings(wildcards.rso, wildcards.stations)),
        "laws": OWN.laws,
        "seed": SEED["split"],
        "days": OWN.answer.durations,
        "note": f"{wildcards.rso} by {wildcards.stations}. {WEATHER}",
    }


def experiment(wildcards):
    """What a file name asks for, as the metrics tell it."""
    parts = dict(wildcards.items())
    naming.check_split(naming.parse_test(parts["test"]), duration_days=config["duration_days"])
    trained, target = parts["rso"], parts["target"]
    if parts["test"] == "seen" and trained != target:
        raise InputError(f"split 'seen': expected the RSO that was trained on, {trained}, got {target}")
    parts["stations"] += parts.pop("window") + parts.pop("reading") + parts.pop("label")
    return parts


def tested_settings(wildcards):
    """What a calibration is told: the experiment, and how long predictions may last."""
    return {
        "epoch": config["epoch"],
        **split(wildcards),
        "span_days": STUDY.span_days,
        "max_days": config["prediction"]["max_days"],
        "experiment": experiment(wildcards),
    }


def path_of(pattern, **parts):
    """The file of a pattern whose parts are given; not by `format`, which would lose the storage it is kept in."""
    return pattern.apply_wildcards(parts)


def paths_of(pattern, *experiments):
    """The files of experiments, each once."""
    return list(dict.fromkeys(path_of(pattern, **experiment.names()) for experiment in experiments))


def simulated(wildcards):
    """End the plan in one line where a file name asks for the truth of tracks that were measured."""
    if wildcards.rso in SETTINGS.tracks:
        known = "what was measured has no truth, and no seed of the noise"
        raise InputError(f"truth of '{wildcards.rso}': expected an RSO without tracks of its own, as {known}")


def true_orbit(wildcards):
    """Input function: the truth of an RSO, none where its tracks were measured."""
    return [] if wildcards.rso in SETTINGS.tracks else path_of(rules.truth.output[0], rso=wildcards.rso)


def first_states(wildcards):
    """Input function: what first fits start from, the truth or the first orbit of tracks that were measured."""
    return true_orbit(wildcards) or path_of(
        rules.first_orbit.output[0], rso=wildcards.rso, stations=wildcards.stations
    )


def known_manoeuvres(wildcards):
    """Input function: the table whose metadata tell manoeuvres, the truth or tracks that were measured."""
    return true_orbit(wildcards) or path_of(
        rules.tracking.output[0], rso=wildcards.rso, stations=wildcards.stations
    )


def at_window(window, pattern):
    """Input function: the file of a pattern, of estimates over that window."""
    return lambda wildcards: path_of(pattern, **dict(wildcards.items()) | {"window": window})


def asked_for(files, part):
    """Input function: what a target makes; ends the plan in one line where the study does not ask for it."""

    def find(wildcards):
        if not files:
            end(f"study: expected {part} to train and to test on, got none; docs/howto.md shows a study")
        return files

    return find


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


def arc_at(pattern):
    """Input function: the file of a pattern, of estimates over the arcs' window."""

    def find(wildcards):
        hours, _ = naming.parse_arc(wildcards.arc)
        window = naming.windowed(hours, default=config["estimation"]["window_hours"])
        return path_of(pattern, rso=wildcards.rso, stations=wildcards.stations, window=window)

    return find


def drawing(name, **settings):
    """Params of a figure: the script that draws it, and what it is told."""
    return {"draw": name, "settings": {"epoch": config["epoch"], **settings}, "code": code(f"{name}.py")}


def drawn_from(*experiments):
    """What the errors of experiments are drawn from: their tables, and the datasets that they are tested on."""
    return {
        "evaluation": paths_of(rules.evaluate.output.evaluation, *experiments),
        "metrics": paths_of(rules.evaluate.output.metrics, *experiments),
        "dataset": [path_of(rules.evaluate.input.target, **one.names()) for one in experiments],
    }


def told_of(experiment, **further):
    """What a figure of an experiment's errors is told of it, and how its rows were cleaned."""
    return {
        "epoch": config["epoch"],
        "cleaning": dict(STUDY.entry("cleaning")),
        **experiment.names(),
        **further,
    }


def all_of(experiments, what):
    """What a figure of several models on one test is told, their names under `what`; ends the plan without one."""
    if not experiments:
        end("study: learners: expected at least one model that corrects, got none")
    names = next(iter(experiments.values())).names() | {"learner": "models"}
    return {"epoch": config["epoch"], "weather": WEATHER, what: list(experiments), **names}
