"""Write the site's page to explore, docs/static/explore.html: Swarm A and a handful of models.

    python -m validation.pictures.explore_page results

Plotly lies beside the page in the site, as it is larger than all else.
"""

import argparse
import sys
from pathlib import Path

from plotly.offline import get_plotlyjs

from opml.base.errors import InputError
from opml.base.files import replacing
from opml.figures import orbit_explorer
from opml.figures.axis_labels import clauses
from opml.figures.display_names import describe_run
from opml.figures.ground_tracks import ObservedOrbit
from opml.study.experiments import Study
from opml.study.own_study import OwnStudy
from opml.study.settings.merging import merged, with_sheets
from opml.tables import read_table
from validation.case import ROOT

PAGE = ROOT / "docs" / "static" / "explore.html"
LEARNERS = ("svr", "mechanism", "fit48", "filter", "running24m3")
"""Models of the page; the last one is shown first."""


def explore_page(results: Path) -> str:
    """Return the page of Swarm A as HTML, with plotly as a file next to it; results: of its study."""
    files = [ROOT / "config" / "config.yaml", ROOT / "config" / "studies" / "swarm.yaml"]
    study = OwnStudy(Study(with_sheets(merged(files).values)))
    ((rso, stations),) = study.datasets
    train, test = study.splits[study.shown_split]
    settings = study.study.settings
    orbit = ObservedOrbit(
        read_table(results / "truth" / f"{rso}.parquet", "truth"),
        read_table(results / "environment" / "earth_orientation.parquet", "earth_orientation"),
        [settings.stations[name] for name in stations.split("-")],
    )
    models = results / "evaluation" / rso / stations / train
    whole = orbit_explorer.page(
        orbit,
        {name: read_table(models / name / f"e_y/{rso}/{test}.parquet", "evaluation") for name in LEARNERS},
        read_table(results / "dataset" / rso / f"{stations}.parquet", "dataset"),
        component="e_y",
        epoch=settings.values["epoch"],
        back="../figures.html",
        note=clauses(describe_run(rso, stations), "models trained on days 0 to 18"),
    )
    return whole.replace(f"<script>{get_plotlyjs()}</script>", '<script src="plotly.min.js"></script>')


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, help="folder with the folder of results of `swarm`")
    try:
        text = explore_page(parser.parse_args().results / "swarm")
    except InputError as error:
        sys.exit(f"opml: {error}")
    with replacing(PAGE) as temporary:
        temporary.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
