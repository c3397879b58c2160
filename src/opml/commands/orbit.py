"""The command `orbit`: where objects were, by the orbits inside their public sets."""

import argparse

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import check_distinct_files, suffix_of
from opml.base.progress import Progress, counted, on_stderr
from opml.commands.command import UTC_TEXT, WEATHER, instant

_OEM = ".oem"


def add(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `orbit`."""
    parser.add_argument("sets", nargs="+", help="files and folders of {elements}")
    parser.add_argument("-o", "--output", required=True, help=_OUTPUT)
    parser.add_argument("--weather", default="NEWEST", help=WEATHER)
    past = parser.add_argument_group("of an object over time")
    past.add_argument("--object", help="name, designator or number, where the files have several objects")
    past.add_argument("--from", dest="begin", type=instant, help=f"{UTC_TEXT} (the first set)")
    past.add_argument("--to", dest="end", type=instant, help="the same (the last set)")
    states = parser.add_argument_group("of a table")
    states.add_argument(
        "--date", type=instant, help="only the newest set of each object that was public then"
    )
    states.add_argument("--before", metavar="FILE", help="such a table of the day before: half of the work")


_OUTPUT = "an object over time, .oem, or a table, a row a set, .csv, .json or .parquet"


def run(options: argparse.Namespace) -> None:
    """Write where an object was, or a table of states."""
    from opml.tables import TABLE_SUFFIXES

    is_table = suffix_of(options.output, [_OEM, *TABLE_SUFFIXES]) != _OEM
    check_distinct_files([options.output], [*options.sets, *filter(None, (options.weather, options.before))])
    _check_unused(options, *(("object", "begin", "end") if is_table else ("date", "before")))
    with on_stderr() as progress:
        (_table if is_table else _past)(options, progress)


def _check_unused(options: argparse.Namespace, *names: str) -> None:
    for name in names:
        if getattr(options, name) is not None:
            option = {"begin": "from", "end": "to"}.get(name, name)
            raise InputError(f"--{option}: expected another kind of output, got {options.output}")


def _past(options: argparse.Namespace, progress: Progress) -> None:
    from opml.element_sets.inside import orbit_history

    asked = {name: getattr(options, name) for name in ("object", "begin", "end", "weather")}
    history = orbit_history.find(options.sets, **asked, progress=progress)
    history.write(options.output)
    print(history.summary())
    print(f"{options.output} is written")


def _table(options: argparse.Namespace, progress: Progress) -> None:
    from opml.element_sets import catalogue as catalogues
    from opml.element_sets.inside import set_states
    from opml.tables import write_as

    catalogue = catalogues.read(options.sets)
    if options.date:
        catalogue = catalogue.until(epochs.mjd(options.date)).newest()
    before = set_states.read_before(options.before) if options.before else None
    table = set_states.build(catalogue, weather=options.weather, before=before, progress=progress)
    write_as(options.output, table, set_states.SCHEMA, metadata={"date": options.date or ""})
    inside = int((table["why"] == "").sum())
    print(f"{options.output}: {counted(inside, 'state')} of {counted(len(table), 'set')}")
