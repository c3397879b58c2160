"""The profile of clusters knows every rule of the workflow."""

import re

import yaml
from project import ROOT
from snakemake.profiles import ProfileConfigFileParser

TEXTS = [path.read_text(encoding="utf-8") for path in (ROOT / "workflow" / "rules").glob("*.smk")]
RULES = {
    name
    for text in TEXTS
    for name in re.findall(r"^\s*(?:rule|use rule \w+ as) (\w+)(?: with)?:", text, re.MULTILINE)
}


def test_every_rule_is_grouped_or_stays_here():
    profile = yaml.safe_load((ROOT / "profiles" / "slurm" / "config.yaml").read_text(encoding="utf-8"))
    local = re.findall(r"^localrules:\n((?: +\w+,\n)+)", "\n".join(TEXTS), re.MULTILINE)
    groups = dict(entry.split("=") for entry in profile["groups"])
    assert groups.keys() | set(re.findall(r"\w+", "".join(local))) == RULES
    assert set(groups.values()) == {entry.split("=")[0] for entry in profile["group-components"]}


def profile(name):
    """The settings of a profile, as Snakemake reads them."""
    with (ROOT / "profiles" / name / "config.yaml").open(encoding="utf-8") as file:
        return ProfileConfigFileParser().parse(file)


def test_other_queues_have_the_groups_of_slurm(monkeypatch):
    monkeypatch.chdir(ROOT)
    slurm, pbs = map(profile, ("slurm", "pbs"))
    for key in ("groups", "group-components", "jobs", "cores"):
        assert pbs[key] == slurm[key]
    assert pbs["executor"] == "cluster-generic"
