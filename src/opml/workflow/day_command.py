"""`opml day`: the workflow's page of a day, made and summed up."""

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from pathlib import Path

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.progress import counted
from opml.catalog.kinds import ELEMENTS
from opml.element_sets import trained_model
from opml.mornings import outcomes
from opml.mornings.kept.store import Store
from opml.mornings.outcomes import DO_NOT_USE
from opml.report.day import document, summary
from opml.report.document import markdown
from opml.study.checks import load_settings
from opml.study.settings.merging import Settings, merged
from opml.workflow import lock

ALL_RUN, WORKFLOW_FAILED, OBJECTS_FAILED = 0, 1, 2
"""Exit codes: all mornings were run, the workflow ended with an error, mornings of some objects did."""

_PROJECT = "config/config.yaml"

_NAMED = 5  # objects and warnings at most

_ARENAS = "2"
"""Heaps of the threads of a job, one an object: of one each they keep a quarter more memory (glibc alone)."""

_LONGER = 28
"""Days by which a run is lengthened at a time: its environment is tabulated again each time."""


@dataclass(frozen=True)
class Call:
    """A call of the command."""

    day: date  # the last date of mornings
    first: date  # the first date that has a page
    configfiles: Sequence[str]  # files of settings
    where: Sequence[str]  # options of Snakemake for where jobs run
    dry: bool  # whether the plan alone is shown


def show(name: str, day: date, configfiles: Sequence[str]) -> None:
    """Print what became of an object on a day; raise InputError where its morning is not over."""
    settings = _settings(configfiles)
    if name not in settings.measured:
        known = ", ".join(list(settings.measured)[:_NAMED])
        raise InputError(f"--object: expected an object of the run, such as {known}, got {name}")
    places = Store(Path(settings.run.results, "days"), "0", [name]).places(day)
    if name not in places:
        raise InputError(f"--object: expected an object whose morning of {day} is over, got {name}")
    print(markdown(document([places[name].outcomes[name]], [], date=day.isoformat())))


def _settings(configfiles: Sequence[str]) -> Settings:
    """Return settings that ask for mornings; raise InputError for others, and without a project."""
    if not Path(_PROJECT).exists():
        raise InputError(f"{_PROJECT}: no such file in {Path.cwd()}; `opml init FOLDER` makes a project")
    source = merged([_PROJECT, *configfiles])
    if "day" not in source.values:
        expected = "expected a setting `day` that asks for mornings, got none in --configfile"
        raise InputError(f"day: {expected}; `day: {{}}` is enough")
    try:
        return load_settings(source)
    except InputError as error:
        hint = ": `opml init --upgrade .` helps a project of an older version"
        raise InputError(f"{error}{hint if str(error).startswith(_PROJECT) else ''}") from None


def run(call: Call) -> int:
    """Run the workflow and print what became of the objects; return the exit code.

    Mornings that failed are tried again. Raises InputError for settings that ask for no mornings, as
    `check_dates` does, and where another run holds the folder of results.
    """
    whole = _settings(call.configfiles)
    settings = whole.run
    check_dates(call, settings.epoch, today=datetime.now(UTC).date())
    duration = lengthened(settings.duration_days, settings.epoch, call.day)
    dates = [date.fromordinal(k).isoformat() for k in range(call.first.toordinal(), call.day.toordinal() + 1)]
    folders = [Path(settings.results, "days", text) for text in dates]
    if not call.dry:
        with lock.hold(Path(settings.results)):
            for folder in folders:
                _forget_failed(folder)
    if mornings := sum(mornings_ahead(call.day, whole).values()):
        text = f"opml: {counted(len(whole.measured), 'object')}, at most {counted(mornings, 'morning')}"
        print(text, file=sys.stderr, flush=True)
    # The last day brings all others up to date, whose pages then only have to be written.
    for pages in [folders[-1:], folders[:-1]]:
        if pages and _snakemake(call, [str(folder / "day.html") for folder in pages], duration):
            return WORKFLOW_FAILED
    if call.dry:
        return ALL_RUN
    page = json.loads((folders[-1] / "day.json").read_text(encoding="utf-8"))
    logs = Path(settings.results, "logs", "days", dates[-1])
    print("\n".join([*_lines(page, folders[-1]), *warned(logs, page["objects"]), *warnings(call.day, whole)]))
    return OBJECTS_FAILED if page["verdicts"].get(outcomes.FAILED) else ALL_RUN


def warned(logs: Path, objects: Iterable[Mapping[str, str]]) -> list[str]:
    """Return what the logs of a morning's jobs warn of, each once: files that were skipped, mostly.

    objects: of the page, whose verdicts say why they failed
    """
    printed = {f"{entry['object']}: {entry['reason']}" for entry in objects}
    texts = (path.read_text(encoding="utf-8") for path in sorted(logs.glob("objects_*.log")))
    lines = (line.partition(" WARNING ")[2] for text in texts for line in text.splitlines())
    distinct = [line for line in dict.fromkeys(filter(None, lines)) if line not in printed]
    more = [f"{len(distinct) - _NAMED} more warnings in {logs}"] if len(distinct) > _NAMED else []
    return distinct[:_NAMED] + more


def warnings(day: date, settings: Settings) -> list[str]:
    """Return the warning where the model that improves sets was trained on what came after a date."""
    if not any(settings.kind_of(rso) is ELEMENTS for rso in settings.measured):
        return []
    return list(filter(None, [trained_model.hindsight(trained_model.packaged_card(), day.isoformat())]))


def mornings_ahead(day: date, settings: Settings) -> dict[str, int]:
    """Return how many mornings of each object are to be run up to a date, at most: tracks may begin later."""
    store = Store(Path(settings.values["results"], "days"), "0", settings.measured)
    before = date.fromisoformat(settings.values["epoch"][:10]) - timedelta(days=1)
    return {rso: (day - (dates[-1] if dates else before)).days for rso, dates in store.done(day).items()}


def lengthened(duration_days: float, epoch: str, day: date) -> float:
    """Return the days of a run that reaches a day: its own, or more by whole _LONGER."""
    missing = (day - date.fromisoformat(epoch[:10])).days - math.ceil(duration_days)
    return duration_days + _LONGER * max(0, math.ceil(missing / _LONGER))


def check_dates(call: Call, epoch: str, *, today: date) -> None:
    """Raise InputError for dates that are no mornings: to come, before the run, or in the wrong order.

    epoch: of the run, UTC text; raises as `epochs.parse` does
    """
    epochs.parse(epoch)
    begin = date.fromisoformat(epoch[:10])
    for option, day in (("--date", call.day), ("--since", call.first)):
        if not begin <= day <= today:
            raise InputError(f"{option}: expected a day from {begin} to {today}, today, got {day}")
    if call.first > call.day:
        raise InputError(f"--since: expected {call.day}, the --date, or a day before it, got {call.first}")


def _snakemake(call: Call, pages: Sequence[str], duration_days: float) -> int:
    how = ["-n"] if call.dry else ["--quiet", "all"]
    settings = ["--configfile", *call.configfiles] if call.configfiles else []
    settings += ["--config", f"duration_days={duration_days:g}"]
    command = [sys.executable, "-m", "snakemake", *call.where, *how, *settings, "--", *pages]
    code = _exit_code(command)
    if code and not call.dry:
        message = "opml: the workflow failed; `opml day -n` shows errors in its plan"
        print(message, file=sys.stderr, flush=True)
    return code


def _exit_code(command: Sequence[str]) -> int:
    """Run a command in a process group of its own, which an interrupt of this process ends; return its code.

    In this one's group each job would print a traceback. Jobs in queues are for Snakemake to end.
    """
    kind = signal.SIGINT if "--profile" in command else signal.SIGKILL
    environment = {"MALLOC_ARENA_MAX": _ARENAS, **os.environ}
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)
    with subprocess.Popen(command, process_group=0, env=environment) as process:
        try:
            return process.wait()
        except KeyboardInterrupt:
            os.killpg(process.pid, kind)
            process.wait()
            raise KeyboardInterrupt("the same command resumes the run") from None


def _forget_failed(folder: Path) -> None:
    """Remove what says that mornings failed, and the page of it, so that the workflow runs them again."""
    failed = [
        path
        for path in folder.glob("objects_*.json")
        if any(outcome["verdict"] == outcomes.FAILED for outcome in outcomes.read(path))
    ]
    for path in (*failed, *(folder.glob("day.*") if failed else ())):
        path.unlink()


def _lines(page: dict[str, list[dict[str, str]]], folder: Path) -> list[str]:
    """Return the summary of a day, a line for each object that should be looked at, or of a few for each."""
    objects = page["objects"]
    few, watched = len(objects) <= _NAMED, (outcomes.FAILED, DO_NOT_USE)
    return [
        f"{page['date']}: {summary(objects)}",
        *(
            f"{entry['object']}: {entry['verdict']}: {entry['reason']}"
            for entry in objects
            if few or entry["verdict"] in watched
        ),
        str(folder / "day.html"),
    ]
