"""The profile of clusters knows every rule of the workflow."""

import re

import yaml
from project import ROOT

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
