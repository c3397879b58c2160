# What all rules share: the settings, checked before there is a DAG, and helpers that need objects of Snakemake.
# The code behind `PLAN`, `PARAMS` and `INPUTS` is in `opml.workflow`.
import os
import sys

from opml import naming, tables
from opml.base.errors import InputError
from opml.base.files import PACKAGED
from opml.catalog import kinds
from opml.base.provenance import contents_digest, script_digest
from opml.report.sections import SECTIONS, section_of
from opml.study.checks import check_data, load_settings
from opml.study.settings.merging import merged
from opml.study.settings.overlay import COMMAND_LINE, Layer, with_numbers
from opml.workflow.inputs import Inputs, at_window, checks, path_of, paths_of, tables_of, target
from opml.workflow.params import Params
from opml.workflow.plan import Plan, end_plan
from opml.workflow.settings_in_tables import compare_tables_with_settings
from opml.workflow.before_first_job import date_back_to_now, hold_results, lift_job_rate, project_settings
from opml.workflow.host import name_python

name_python()

if sum(option in ("--configfile", "--configfiles") for option in sys.argv) > 1:
    end_plan(
        "--configfile: expected all files after one --configfile, as Snakemake forgets those of an earlier one"
    )
if workflow.modifier.is_main_snakefile():
    # Files of the command line are laid over the project's, which may be in another folder than this file.
    FILES = [project_settings(), *map(os.path.relpath, workflow.config_settings.configfiles)]
    ON_TOP = Layer(COMMAND_LINE, with_numbers(workflow.config_settings.config))
else:
    # A module: the settings of the workflow around it are laid over those that come with the package.
    FILES, ON_TOP = [PACKAGED], Layer("config", with_numbers(config))
try:
    SOURCE = merged(FILES, ON_TOP)
    PLAN = Plan(load_settings(SOURCE))
    if workflow.is_main_process:  # each job parses this file anew
        check_data(SOURCE, PLAN.settings)
        compare_tables_with_settings()
except InputError as error:
    end_plan(error)
# A new mapping, as that of a module may belong to the workflow around it.
config = dict(PLAN.values)

PARAMS = Params(PLAN)
INPUTS = Inputs(PLAN, PARAMS)
ENVIRONMENT = PLAN.environment
STUDY, PAPER, OWN = PLAN.study, PLAN.paper, PLAN.own_study
product = PLAN.product


wildcard_constraints:
    **PLAN.constraints,


def code(script):
    """Return the digest of the modules that a script uses: a param that reruns the rule when one changes."""
    return script_digest(workflow.source_path(f"../scripts/{script}"))


def users(paths):
    """Return the user's own files as inputs that no storage takes."""
    return [local(path) for path in paths]


def contents(paths):
    """Return the content of the user's own files as a setting: a time stamp may be older than what it replaces."""
    return {"contents": contents_digest(paths)} if paths else {}


def drawing(name, settings):
    """Return the params of a figure or document: its script, by name, and the settings of that script."""
    return {"draw": name, "settings": settings, "code": code(f"{name}.py")}


def figures(*products, section, caption=None):
    """Return the outputs of figures: PDF, and PNG in the report."""
    png = [in_report(figure, "png", section, caption) for figure in products]
    return {"pdf": [figure.file("pdf") for figure in products], "png": png}


def documents(*products, section, caption=None):
    """Return the outputs of documents: Markdown, tab-separated text, and HTML in the report."""
    outputs = {suffix: [document.file(suffix) for document in products] for suffix in ("md", "tsv")}
    return outputs | {"html": [in_report(document, "html", section, caption) for document in products]}


def in_report(shown, suffix, section, caption=None):
    """Return an output with its section of the report; its caption has its name, unless `caption` is another."""
    caption = f"../report/{caption or shown.title}.rst"
    return report(shown.file(suffix), caption=caption, category=section, labels={"shows": shown.title})


def true_errors(rso, stations):
    """Return the dataset of an RSO and a station set with true errors."""
    return path_of(rules.dataset.output[0], rso=rso, stations=stations, window="", reading="")


def labelled(rso, stations):
    """Return the dataset of an RSO and a station set with the errors that the study learns from."""
    parts = {"rso": rso, "stations": stations, "window": "", "reading": ""}
    return path_of(rules.labelled_dataset.output[0], **parts, label=naming.LABELS[STUDY.label])
