"""Take an orbit of one's own for the true orbit of an RSO."""

from opml.base.constants import DAY
from opml.interop import truth_from_orbit
from opml.interop.orbit_from_files import OrbitFiles
from opml.tables import write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    files = OrbitFiles(
        list(snakemake.input),
        settings.epoch,
        DAY * settings.duration_days,
        positions_alone=settings.positions_alone,
    )
    table, facts = truth_from_orbit.truth(files, step=settings.step_s)
    write_table(snakemake.output[0], table, "truth", metadata=metadata | facts)
