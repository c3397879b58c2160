"""Files of what was measured of an object."""

import pytest
from support import EPOCH, EXCERPTS, environment, stations

from opml.base.constants import DAY
from opml.catalog import measured_files
from opml.catalog.measured_files import MeasurementSource, Span
from opml.interop.object_ids import ObjectId


@pytest.mark.parametrize(
    ("participant", "identity"),
    [("25544", ObjectId("", "", 25544)), ("1998-067A", ObjectId("", "1998-067A")), ("ISS", ObjectId("ISS"))],
)
def test_the_participant_of_tracks_tells_the_object(tmp_path, participant, identity):
    text = (EXCERPTS / "orekit.tdm").read_text().replace("= ISS\n", f"= {participant}\n")
    (tmp_path / "mine.tdm").write_text(text)
    source = MeasurementSource(kind="tracks", files=[str(tmp_path / "mine.tdm")], options={})
    span = Span(EPOCH, 2 * DAY)
    sheet, orientation = list(stations().values()), environment()["earth_orientation"]
    assert measured_files.read(source, span, sheet, orientation, since=0.0).identity == identity
