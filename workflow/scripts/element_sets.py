"""Read the history of an RSO's mean elements."""

from opml.base.section import JobSettings
from opml.interop import object_ids
from opml.interop.element_sets import histories
from opml.interop.element_sets.measured_sets import HistoryTaking
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    taking: HistoryTaking


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    history = histories.read(
        snakemake.input, epoch=settings.epoch, leave_out_damaged=settings.taking.leave_out_damaged
    )
    sets = histories.of_object(history.sets, settings.taking.number)
    metadata |= object_ids.facts(history.objects[sets["number"].iloc[0]])
    metadata |= {"damaged": len(history.damaged), "doubles": history.doubles}
    write_table(snakemake.output[0], sets, "element_sets", metadata=metadata)
