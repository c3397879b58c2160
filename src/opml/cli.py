"""The command `opml`: what its subcommands read and print."""

import argparse
import io
import logging
import os
import re
import sys
from collections.abc import Callable, Sequence
from datetime import UTC, date, datetime
from itertools import chain, groupby
from typing import TYPE_CHECKING

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import check_distinct_files, check_folder, suffix_of
from opml.base.progress import clear, counted, on_stderr
from opml.commands import benchmark, orbit
from opml.commands.command import LATENCY, UTC_TEXT, WEATHER, Command, instant, latency

if TYPE_CHECKING:
    from opml.base.progress import Progress
    from opml.element_sets.prediction import Prediction
    from opml.interop.predicted_orbit import PredictedOrbit


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a subcommand; return the exit code, 1 after one line that tells why."""
    warnings = logging.StreamHandler()
    warnings.addFilter(_first_of_each())
    logging.basicConfig(format=f"{clear()}opml: %(message)s", handlers=[warnings])
    if isinstance(sys.stdout, io.TextIOWrapper):  # of names that the terminal has no letters for
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        options = _parser().parse_args(_readable(sys.argv[1:] if arguments is None else arguments))
        options.run(options)
        sys.stdout.flush()
    except BrokenPipeError:  # whoever reads has enough, such as `head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (InputError, OSError) as error:
        print(f"opml: {error}", file=sys.stderr)
        return 1
    return 0


def _first_of_each() -> Callable[[logging.LogRecord], bool]:
    """Return a filter that passes each message once: a file may be read more than once."""
    messages: set[str] = set()

    def is_new(record: logging.LogRecord) -> bool:
        before = len(messages)
        messages.add(record.getMessage())
        return len(messages) > before

    return is_new


class _Help(argparse.HelpFormatter):
    """Help that names the formats which are read."""

    def _get_help_string(self, action: argparse.Action) -> str:
        from opml.interop import formats

        return formats.filled_in(action.help or "")


class _Intermixed(argparse.ArgumentParser):
    """A parser of a command whose files may stand on both sides of an option."""

    _is_inner = False  # whether argparse calls it for options and files apart

    def parse_known_args(  # type: ignore[override]  # of several forms
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        if self._is_inner:
            return super().parse_known_args(args, namespace)
        self._is_inner = True
        return self.parse_known_intermixed_args(args, namespace)


def _readable(arguments: Sequence[str]) -> list[str]:
    """Return arguments as argparse reads them: - is standard input, and a latitude may be below 0."""
    text = "\0".join("/dev/stdin" if argument == "-" else argument for argument in arguments)
    return re.sub(r"(^|\0)(--station)\0(-\d)", r"\1\2=\3", text).split("\0") if text else []


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="opml",
        description="Orbit prediction improved by machine learning.",
        epilog="\n".join(
            f"{group}:\n" + "\n".join(f"  {command.name:10} {command.help}" for command in commands)
            for group, commands in GROUPS.items()
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"opml {__version__}")
    parser.set_defaults(run=lambda _: parser.print_help())
    subparsers = parser.add_subparsers(
        metavar="COMMAND", help="one of the commands below", parser_class=_Intermixed
    )
    for command in COMMANDS:
        subparser = subparsers.add_parser(command.name, description=command.help, formatter_class=_Help)
        command.add_arguments(subparser)
        subparser.set_defaults(run=command.run)
    return parser


# The modules behind a command are imported when it runs: some need packages of an extra, some take a second.


def _add_init(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", help="the project's folder; created if missing")
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--elements", metavar="FILE", help="element sets of an object, for its mornings")
    kinds.add_argument("--orbit", nargs="+", metavar="FILE", help="its positions: {orbit}")
    kinds.add_argument("--upgrade", action="store_true", help="bring a project to this version")


def _init(options: argparse.Namespace) -> None:
    from opml.workflow import new_project
    from opml.workflow.first_project import FirstProject

    if options.upgrade:
        new_project.upgrade(options.folder)
        print(f"{options.folder}: of opml {__version__}; what it replaced is in *{new_project.BEFORE}")
    elif options.elements or options.orbit:
        by_sets = bool(options.elements)
        project = FirstProject.of_sets(options.elements) if by_sets else FirstProject.of_points(options.orbit)
        new_project.write(options.folder, project.text, project.copied)
        print(project.chosen)
        print(new_project.next_steps(options.folder, project.command))
    else:
        new_project.write(options.folder)
        print(new_project.next_steps(options.folder))


def _add_rso(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", help="an element set: {elements}")
    parser.add_argument("--name", required=True, help="name in the sheet: lower-case letters and digits")
    parser.add_argument("--epoch", required=True, type=instant, help=f"epoch of the run, {UTC_TEXT}")
    parser.add_argument("--area-to-mass", type=float, required=True, help="area over mass [m2/kg]")
    parser.add_argument("--cd", type=float, required=True, help="drag coefficient")
    parser.add_argument("--cr", type=float, required=True, help="reflectivity coefficient")


def _rso(options: argparse.Namespace) -> None:
    from opml.interop.element_sets import mean_elements

    asked = {name: getattr(options, name) for name in ("name", "epoch", "area_to_mass", "cd", "cr")}
    print(mean_elements.line_of_sheet(options.file, **asked))


def _add_screen(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("ours", help="our object's orbit ({orbit}) or sets; alone, a catalogue or a CDM")
    parser.add_argument("others", nargs="*", help="orbits and element sets of other objects")
    parser.add_argument("--within", type=float, help="largest distance [km] (5); not of a CDM")
    parser.add_argument("--radius", type=float, help="sum of the radii of two objects [m] (20, or a CDM's)")
    parser.add_argument("--days", type=float, default=7.0, help="days to screen without an orbit (7)")
    parser.add_argument("--weather", default="NEWEST", help=WEATHER)
    printed = parser.add_mutually_exclusive_group()
    printed.add_argument("--csv", action="store_true", help="as comma-separated values")
    printed.add_argument("--json", action="store_true", help="as a list of objects, null where unknown")
    parser.add_argument("--messages", metavar="FOLDER", help="where to write a CDM of each with covariances")


def _screen(options: argparse.Namespace) -> None:
    from opml import tables
    from opml.conjunctions import as_text, cdm, from_files
    from opml.interop.ephemeris import EPOCH

    if options.messages:
        check_folder(os.path.join(options.messages, "*.cdm"))
    limits = {name: getattr(options, name) for name in ("within", "radius", "days", "weather")}
    conjunctions = from_files.conjunctions([options.ours, *options.others], **limits)
    if options.messages:
        conjunctions = list(conjunctions)
        cdm.write_all(options.messages, conjunctions, epoch=EPOCH)
    table = as_text.table(conjunctions, epoch=EPOCH)
    if options.csv:
        tables.comma_separated(table, sys.stdout)
    elif options.json:
        print(table.to_json(orient="records", indent=1, double_precision=15))
    else:
        print(as_text.text(table))


def _add_compare(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("ours", help="an orbit: {orbit}, {elements}")
    parser.add_argument(
        "other", nargs="+", help="the truth, in one file or several; before it orbits of other formats"
    )
    parser.add_argument("--object", help="name or number of the object in the first, where it has several")
    parser.add_argument("--other-object", help="the same of the second")
    parser.add_argument("-o", "--output", help="every time: .csv, .json or .parquet")


def _compare(options: argparse.Namespace) -> None:
    from opml import tables
    from opml.interop import comparison, formats, known_orbits
    from opml.interop.orbit_arcs import contents

    if options.output:
        suffix_of(options.output, tables.TABLE_SUFFIXES)
        check_distinct_files([options.output], [options.ours, *options.other])
    kinds = (formats.ORBIT, formats.ELEMENTS, formats.TABLE)
    groups = groupby(  # a folder is one of sets
        options.other, lambda path: os.path.isdir(path) or formats.of(path, contents(path), *kinds).name
    )
    *between, truth = (list(paths) for _, paths in groups)
    other = known_orbits.read(truth, options.other_object)
    compared = {
        paths[0]: comparison.compare(known_orbits.read(paths, options.object), other)
        for paths in ([options.ours], *between)
    }
    if options.output:
        metadata = {"ours": options.ours, "other": truth}
        tables.write_as(options.output, compared[options.ours], "comparison", metadata=metadata)
    print(comparison.summary(compared[options.ours]))
    if between:
        print(comparison.side_by_side(compared, truth[0]))


def _add_improve(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("sets", nargs="*", help="files and folders of {elements} (all that was fetched)")
    parser.add_argument("-o", "--output", required=True, help="better sets: .tle, .json, .csv, .xml or .kvn")
    parser.add_argument("--table", help="what was done, and the errors expected: .csv, .json or .parquet")
    parser.add_argument("--date", type=instant, help=f"{UTC_TEXT}: only what was public then counts (now)")
    parser.add_argument("--latency", type=float, help=LATENCY)
    parser.add_argument("--weather", default="NEWEST", help=WEATHER)
    parser.add_argument("--model", help="a model of `opml train` (that of the package)")


def _improve(options: argparse.Namespace) -> None:
    from opml.element_sets import improve, improved_summary, trained_model
    from opml.fetch import public_data

    sets = options.sets or [public_data.sets_folder()]
    improve.check_written(
        options.output, options.table, [*sets, *filter(None, (options.weather, options.model))]
    )
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S")
    date = now if options.date is None else options.date
    known = improve.read(sets, date=date, weather=options.weather, latency=latency(options))
    with on_stderr() as progress:
        better = improve.improve(known, trained_model.read(options.model), progress=progress)
    missing = better.write(options.output)
    if options.table:
        better.write_table(options.table)
    beyond = f", {missing} without a number that a TLE has" if missing else ""
    print(f"{options.output}: {counted(len(better.sets) - missing, 'set')}{beyond}")
    print(improved_summary.text(better.table))
    if better.hindsight:
        print(better.hindsight)


def _add_predict(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "files", nargs="+", help="sets ({elements}), points ({orbit}), tracks ({tracks}); or a number, a name"
    )
    parser.add_argument("-o", "--output", action="append", default=[], help=_PREDICTED)
    parser.add_argument("--object", help="name, designator or number, where the files have several objects")
    parser.add_argument("--days", type=float, default=7.0, help="length of the prediction (7)")
    parser.add_argument("--date", type=instant, help=f"{UTC_TEXT} (when the newest was known)")
    parser.add_argument("--weather", default="NEWEST", help=WEATHER)
    parser.add_argument("--station", action="append", default=[], help="latitude,longitude,altitude [deg, m]")
    parser.add_argument("--mask", type=float, default=5.0, help="least elevation of passes [deg] (5)")
    parser.add_argument("--passes", metavar="FILE", help="passes over all stations: .csv, .json or .parquet")
    sets = parser.add_argument_group("of element sets")
    sets.add_argument("--catalogue", nargs="+", default=[], help="sets of other objects, to compare with")
    sets.add_argument("--model", help="a model of `opml train` (that of the package)")
    sets.add_argument("--latency", type=float, help=LATENCY)
    measured = parser.add_argument_group("of points and tracks")
    measured.add_argument("--area-to-mass", type=float, help="area over mass [m2/kg] (a guess, or by light)")
    measured.add_argument("--radars", default="config/stations.tsv", help="sheet of the stations of tracks")


_PREDICTED = "what is written, each by its suffix: .oem, .tle, .kvn, .xml, .csv, .json, .czml, .html"


def _predict(options: argparse.Namespace) -> None:
    from opml import tables
    from opml.element_sets import station_passes
    from opml.fetch import public_data
    from opml.interop import formats
    from opml.interop.predicted_orbit import UNKNOWABLE
    from opml.workflow import prediction_files

    prediction_files.check(options.output)
    check_distinct_files(
        [*options.output, *filter(None, [options.passes])],
        [*options.files, *options.catalogue, options.radars, *filter(None, (options.weather, options.model))],
    )
    if options.passes:
        suffix_of(options.passes, tables.TABLE_SUFFIXES)
    places = [station_passes.place(text) for text in options.station]
    mask = station_passes.mask(options.mask)
    with on_stderr() as progress:
        options.files, fetched = public_data.sets_or_files(options.files, progress)
        options.object = fetched if options.object is None else options.object
        kind = formats.kind_of(options.files[0], formats.ELEMENTS, formats.ORBIT, formats.TRACKS)
        prediction = (_propagate_sets if kind == formats.ELEMENTS else _fit)(options, progress)
    orbit, date = prediction.ephemeris, prediction.date
    over = {place: station_passes.passes(orbit, date, place, mask) for place in places}
    for path in options.output:
        prediction_files.write(path, prediction, over)
    if options.passes:
        prediction_files.write_passes(options.passes, over)
    print(f"{prediction.identity} from {prediction.date} UTC: {prediction.way} ({prediction.reason})")
    expected = (
        prediction.expected().dropna(axis="columns", how="all").replace({"utc": r"\.0+$"}, "", regex=True)
    )
    if "along_track" in expected:
        print("expected errors by lead [d], one sigma [m]:")
    print(expected.to_string(index=False, float_format="{:.0f}".format))
    print(UNKNOWABLE)
    if line := prediction.past_in_words:
        print(line)
    if over:
        print(station_passes.text(over))
    for path in [*options.output, *filter(None, [options.passes])]:
        print(f"{path} is written")


def _propagate_sets(options: argparse.Namespace, progress: "Progress") -> "Prediction":
    from opml.element_sets import prediction

    if options.area_to_mass is not None:
        raise InputError("--area-to-mass: expected points or tracks to fit, got element sets")
    asked = {name: getattr(options, name) for name in ("days", "object", "date", "weather", "catalogue")}
    asked |= {"trained": options.model, "latency": latency(options)}
    return prediction.predict(options.files, **asked, progress=progress)


def _fit(options: argparse.Namespace, progress: "Progress") -> "PredictedOrbit":
    from opml.base.files import project_file
    from opml.mornings.prediction_request import Request
    from opml.orbits.sheets import read_stations
    from opml.study import prediction
    from opml.workflow import prediction_files

    prediction_files.check_fitted(options.output)
    if options.catalogue or options.model or options.latency is not None:
        raise InputError("--catalogue, --model, --latency: expected element sets, got points or tracks")
    asked = {name: getattr(options, name) for name in ("days", "object", "date", "weather", "area_to_mass")}
    stations = list(read_stations(project_file(options.radars)).values())
    request = Request(options.files, **asked, stations=stations)
    return prediction.of_measurements(request, progress=progress)


def _add_fetch(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "objects", nargs="*", help="numbers and names (without any: all that were fetched before)"
    )
    parser.add_argument("--group", action="append", default=[], help="CelesTrak's, as active or stations")
    parser.add_argument(
        "--since",
        metavar="DATE",
        type=date.fromisoformat,
        help="Space-Track's history of these from a day on, with your account (extra spacetrack)",
    )


def _fetch(options: argparse.Namespace) -> None:
    from opml.fetch import public_data, space_track
    from opml.fetch.public_data import Query

    asked = [*map(Query.of, options.objects), *(Query("group", name) for name in options.group)]
    asked = asked or public_data.queries()
    public_data.renew(asked, say=print)
    if options.since:
        space_track.renew(asked, options.since, say=print)


def _add_train(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("sets", nargs="+", metavar="[NAME=]PATH", help="files and folders by population")
    parser.add_argument("-o", "--output", required=True, help="the model, .parquet")
    parser.add_argument(
        "--date", type=instant, help=f"{UTC_TEXT}; what became known later is not learned from"
    )
    parser.add_argument("--weather", default="OBSERVED", help="space weather, CSSI (that of the package)")


def _train(options: argparse.Namespace) -> None:
    from opml.element_sets import trained_model, training

    populations: dict[str, list[str]] = {}
    for text in options.sets:
        name, is_named, path = text.rpartition("=")
        if is_named and not (name and path):
            raise InputError(f"{text}: expected NAME=PATH or PATH, got no {'path' if name else 'name'}")
        populations.setdefault(name if is_named else "all", []).append(path)
    suffix_of(options.output, [trained_model.SUFFIX])
    check_distinct_files([options.output], [options.weather, *chain.from_iterable(populations.values())])
    with on_stderr() as progress:
        asked = {"weather": options.weather, "date": options.date}
        trained = training.train(populations, **asked, progress=progress)
    trained_model.write(options.output, trained)
    print(f"{options.output}: {', '.join(populations)}")


def _add_day(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--date", type=date.fromisoformat, help="the day, as 2016-10-05 (today, UTC)")
    parser.add_argument("--since", type=date.fromisoformat, help="first day that gets a page (the same)")
    parser.add_argument("--configfile", nargs="*", default=[], help="files of settings")
    parser.add_argument("--object", help="print what became of this one, and process nothing")
    parser.add_argument("-j", "--cores", type=int, help="cores (2)")
    parser.add_argument("--profile", help="a profile of Snakemake, as profiles/slurm")
    parser.add_argument("-n", "--dry-run", action="store_true", help="show the plan alone")


def _day(options: argparse.Namespace) -> None:
    from opml.workflow import day_command

    day = options.date or datetime.now(UTC).date()
    if options.object is not None:
        return day_command.show(options.object, day, options.configfile)
    call = day_command.Call(day, options.since or day, options.configfile, _where(options), options.dry_run)
    if code := day_command.run(call):
        sys.exit(code)


def _where(options: argparse.Namespace) -> list[str]:
    """Return the options of Snakemake that tell where jobs run; the number of cores may be a profile's."""
    if options.cores is not None and options.cores < 1:
        raise InputError(f"--cores: expected 1 or more, got {options.cores}")
    if options.profile:
        return ["--profile", options.profile, *([f"-j{options.cores}"] if options.cores else [])]
    return [f"-j{options.cores or 2}"]


def _add_table(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", help="a table of a run, in Parquet")
    parser.add_argument("--csv", action="store_true", help="print the whole table as comma-separated values")


def _table(options: argparse.Namespace) -> None:
    from opml import tables

    if options.csv:
        tables.write_csv(options.file, sys.stdout)
    else:
        print(tables.head(options.file))


def _add_docs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("page", nargs="?", help="name of a page; without it, all pages are listed")


def _docs(options: argparse.Namespace) -> None:
    from opml.workflow import manual

    print(manual.page(options.page) if options.page else manual.contents())


GROUPS = {
    "orbits": (
        Command("fetch", "fetch space weather, Earth orientation and element sets", _add_fetch, _fetch),
        Command("predict", "predict an object from element sets, points or tracks", _add_predict, _predict),
        Command("improve", "improve element sets, as a catalogue taught", _add_improve, _improve),
        Command("orbit", "where objects were, by the orbits inside their sets", orbit.add, orbit.run),
        Command("compare", "compare two orbits over time", _add_compare, _compare),
        Command("screen", "find close approaches of ephemerides", _add_screen, _screen),
    ),
    "a benchmark": (
        Command("score", "score answers to a task of the benchmark", benchmark.add_score, benchmark.score),
        Command("answer", "answer a task with a baseline", benchmark.add_answer, benchmark.answer),
        Command("task", "make a task and its truth from sets or orbits", benchmark.add_task, benchmark.task),
        Command("truth", "make the truth of a hidden task", benchmark.add_truth, benchmark.truth),
    ),
    "a project": (
        Command("init", "create a project with a first study", _add_init, _init),
        Command("day", "process a day: fit, score and issue ephemerides of all objects", _add_day, _day),
        Command("rso", "print the line of the RSO sheet for an element set", _add_rso, _rso),
        Command("train", "train a model that improves element sets", _add_train, _train),
        Command("table", "describe a table, or print it as CSV", _add_table, _table),
    ),
    "help": (Command("docs", "list the pages of the documentation, or print one", _add_docs, _docs),),
}
"""The subcommands, in the order of the help, by what they are for."""

COMMANDS = [command for commands in GROUPS.values() for command in commands]
