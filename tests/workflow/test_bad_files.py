"""Tables, models and names of targets made wrong, through the real command line."""

import os
import shutil

import pyarrow as pa
import pyarrow.parquet as pq
from data_files import sound_files
from project import Project, jobs
from refusals import amiss

CI = "--configfile=config/ci.yaml"
NAMES = {"gravity_field": "field.gfc", "solar_activity": "sun.txt"}


def test_the_sound_data_files_are_taken(project):
    sound = sound_files()
    files = {"gravity_field": "gravity", "solar_activity": "activity"}
    for setting, kind in files.items():
        (project.folder / NAMES[setting]).write_bytes(sound[kind])
    overlay = ", ".join(f"{setting}: {name}" for setting, name in NAMES.items())
    told = project.snakemake("-n", CI, "--config", f"environment={{{overlay}}}").stdout
    assert "opml: " not in told
    assert "Gravity field of Earth: field.gfc" in told
    assert "Solar activity: sun.txt" in told
    assert {name: jobs(told)[name] for name in files} == dict.fromkeys(files, 1)


def rewritten(path, change):
    """A table written again, changed, as another tool would."""
    table = pq.read_table(path)
    pq.write_table(change(table), path)


def without_a_column(path):
    rewritten(path, lambda table: table.drop_columns([table.column_names[-1]]))


def with_another_type(path):
    last = pq.read_schema(path).names[-1]
    rewritten(path, lambda table: table.set_column(len(table.column_names) - 1, last, pa.nulls(len(table))))


def without_metadata(path):
    rewritten(path, lambda table: table.replace_schema_metadata(None))


def with_a_row_less(path):
    rewritten(path, lambda table: table.slice(1))


def with_another_unit(path):
    rewritten(path, lambda table: table.cast(pa.schema([f.remove_metadata() for f in table.schema])))


def halved(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def emptied(path):
    path.write_bytes(b"")


def as_text(path):
    path.write_text("track,t,x\n0,1.0,2.0\n")


def with_a_bit_flipped(path):
    column = pq.read_metadata(path).row_group(0).column(0)
    content = bytearray(path.read_bytes())
    content[column.data_page_offset + column.total_compressed_size - 1] ^= 4
    path.write_bytes(content)


TABLES = {
    "environment/earth_orientation": "truth/iss",
    "environment/ephemerides": "truth/iss",
    "environment/gravity_field": "truth/iss",
    "environment/solar_activity": "truth/iss",
    "truth/iss": "tracking/iss/eglin",
    "tracking/iss/eglin": "estimates/iss/eglin",
    "estimates/iss/eglin": "predictions/iss/eglin",
    "predictions/iss/eglin": "dataset/iss/eglin",
    "dataset/iss/eglin": "models/iss/eglin/random-80/svr/e_y",
    "models/iss/eglin/random-80/svr/e_y": "evaluation/iss/eglin/random-80/svr/e_y/iss/rest",
}
CHANGES = (
    *(without_a_column, with_another_type, without_metadata, with_a_row_less, with_another_unit),
    *(halved, emptied, as_text, with_a_bit_flipped),
)
RULES = {
    "truth": "truths",
    "estimates": "estimation",
    "predictions": "prediction",
    "models": "train",
    "evaluation": "evaluate",
}


def linked(source, copy):
    """A table without its bytes copied, as none is ever written in place; anything else as a copy."""
    return os.link(source, copy) if source.endswith(".parquet") else shutil.copy2(source, copy)


def test_a_wrong_table_of_every_kind_is_told_by_its_rule(finished, tmp_path):
    def tell(folder, case):
        read, made, change = case
        shutil.copytree(finished.folder, folder, dirs_exist_ok=True, copy_function=linked)
        damaged, target = (folder / "results" / "ci" / f"{name}.parquet" for name in (read, made))
        content = damaged.read_bytes()
        damaged.unlink()
        damaged.write_bytes(content)
        change(damaged)
        target.unlink()
        rule = RULES.get(made.split("/")[0], made.split("/")[0])
        options = ("-j1", CI, "--rerun-triggers", "mtime", "--allowed-rules", rule, "--")
        done = Project(folder).snakemake(*options, f"results/ci/{made}.parquet", check=False)
        if not target.exists():
            shutil.rmtree(folder / "results")
        return done, f"opml: results/ci/{read}.parquet: "

    cases = [
        (read, made, CHANGES[number % len(CHANGES)]) for number, (read, made) in enumerate(TABLES.items())
    ]
    assert amiss(cases, tell, tmp_path) == []


IMPOSSIBLE = (  # one name for each rule that looks at its own
    *("truth/iss_i181", "tracking/iss/kaena-eglin", "dataset/iss/eglin-eglin"),
    *("models/iss/eglin/days-0-51/svr/e_y", "metrics/iss/eglin/random-80/svr/e_y/iss/days-60-70"),
)
UNKNOWN = (  # one name for each rule that takes less than others do
    *("truth/../../evil", "estimates/iss/eglin_w0", "predictions/iss/eglin_b12", "dataset/iss/eglin_kept"),
    *("models/iss/eglin/random-80/svr_s2/e_y", "metrics/iss/eglin/random-80/svr/e_y/iss/rest-zscore"),
)


def test_names_of_what_cannot_be_are_told_before_any_job_starts(tmp_path):
    def tell(folder, name):
        done = Project(folder).snakemake("-j1", f"results/{name}.parquet", check=False)
        return done, "opml: "

    assert amiss(IMPOSSIBLE, tell, tmp_path) == []


def test_names_that_no_rule_makes_are_said_to_be_so(tmp_path):
    def tell(folder, name):
        done = Project(folder).snakemake("-j1", f"results/{name}.parquet", check=False)
        # Snakemake's own words stand in for ours.
        done.stdout = done.stdout.replace("No rule to produce ", "\nopml: No rule to produce ")
        return done, "opml: No rule to produce "

    assert amiss(UNKNOWN, tell, tmp_path) == []
