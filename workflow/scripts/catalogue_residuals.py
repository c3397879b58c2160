"""Train a corrector on half of the objects in a season, and judge it on the others in a later one."""

from opml.base.section import JobSettings
from opml.element_sets import corrector_trial
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    seasons: dict[str, list[str]]
    learner: str
    seed: int


# The processes that learn the parts read this file, too.
if __name__ == "__main__":
    with job(snakemake) as metadata:
        settings = Settings(**snakemake.params.settings)
        residuals = corrector_trial.residuals(
            read_table(snakemake.input.rows, corrector_trial.ROWS),
            read_table(snakemake.input.others, corrector_trial.ROWS),
            corrector_trial.Seasons.of_dates(**settings.seasons),
            settings.learner,
            seed=settings.seed,
        )
        write_table(snakemake.output[0], residuals, "catalogue_residuals", metadata=metadata)
