"""The tour of docs/index.md: its numbers are those of the commands that it names."""

import re

import pytest
from support import REPOSITORY, shared

from opml.conjunctions import cdm
from opml.element_sets import prediction, station_passes
from opml.interop.ephemeris import EPOCH
from validation.pictures import tour

CASE = "real/cara/000020580_conj_000002017_20230613_001923_20230608_063715.cdm.gz"
TEXT = " ".join((REPOSITORY / "docs" / "index.md").read_text(encoding="utf-8").split())


@pytest.mark.slow
def test_hubble_s_numbers_are_those_of_the_page():
    sets, weather = "real/tle/victor_HUBBLE.tle.gz", "real/catalogue/sw_cssi_2026-10-15.txt.gz"
    predicted = prediction.predict([str(shared(sets))], date=tour.DATE, weather=str(shared(weather)))
    outwards, across = re.search(r"agree to (\d+ m outwards and) (\d+ m across)", predicted.reason).groups()
    assert f"agree to {outwards} {across}" in TEXT
    expected = predicted.expected().set_index("lead")
    along, cross, radial = expected.loc[3, ["along_track", "cross_track", "radial"]]
    assert f"{along / 1e3:.1f} km along the track, {cross:.0f} m across and {radial:.0f} m outwards" in TEXT
    passes = station_passes.passes(predicted.ephemeris, predicted.date, station_passes.place(tour.STATION))
    assert f"late by at most {passes['early_or_late'].max():.1f} s" in TEXT
    (conjunction,) = cdm.read(str(shared(CASE)), epoch=EPOCH)
    assert f"{conjunction.relative[1] / 1e3:.1f} km ahead" in TEXT
    assert f"is {conjunction.chance.probability:.1e}".replace("e-0", "e-") in TEXT
    sigmas, late, plane = tour.tour(predicted.expected(), passes, conjunction).axes
    assert len(sigmas.lines) == 4
    assert len(late.lines[0].get_xdata()) == len(passes)
    assert len(plane.patches) == 3
