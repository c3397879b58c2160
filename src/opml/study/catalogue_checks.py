"""Checks of a study of a catalogue: its tests against each other, and the user's files."""

from pathlib import Path

from opml.base import epochs
from opml.environment import known_weather
from opml.study.settings.merging import Settings
from opml.study.settings.overlay import Source


def check(source: Source, settings: Settings) -> None:
    """Raise InputError for a test of an unknown population, or one that does not follow its training."""
    known, tests = settings.catalogue_files, settings.catalogue.tests if settings.catalogue else {}
    for name, test in tests.items():
        key = ("catalogue", "tests", name)
        for role, population in (("population", test.population), ("taught_by", test.teachers)):
            if population not in known:
                expected = f"expected one of {', '.join(known)}, got {population!r}"
                raise source.wrong((*key, role), expected)
        dates = [*test.train, *test.test]
        with source.naming(key):
            for date in dates:
                epochs.parse(f"{date}T00:00:00")
        is_later = test.taught_by is not None and dates[2] <= dates[3] < dates[0] <= dates[1]
        if not (dates[0] <= dates[1] < dates[2] <= dates[3] or is_later):
            expected = "expected dates to train on before those to test on, or later ones under taught_by"
            raise source.wrong(key, f"{expected}, got {', '.join(dates)}")


def check_files(source: Source, settings: Settings) -> None:
    """Raise InputError where element sets or orbits are missing, or the weather is unreadable."""
    kinds = {
        ("files", "element sets (TLE, OMM)"): settings.catalogue_files,
        ("orbits", "a table of `opml orbit`"): settings.catalogue_orbits,
    }
    for (kind, expected), populations in kinds.items():
        for name, files in populations.items():
            key = ("catalogue", "populations", name, kind)
            for file in files:
                if "{" in file:
                    raise source.wrong(key, f"expected a path without braces, got {file}")
                if not Path(file).exists():
                    raise source.wrong(key, f"{file}: no such file; expected {expected}")
    if settings.catalogue:
        with source.naming(("catalogue", "weather")):
            known_weather.read(settings.catalogue.weather)
