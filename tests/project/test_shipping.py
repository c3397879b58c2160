"""What ships the project: the image, the hosted tests, the metadata of a release."""

import json
import re
import tomllib

import pytest
import yaml
from support import REPOSITORY

MAKEFILE = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
STEPS = re.findall(r"^(\w+) (.*)$", (REPOSITORY / "Dockerfile").read_text(encoding="utf-8"), re.MULTILINE)
CI = yaml.safe_load((REPOSITORY / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_image_copies_files_that_are_there():
    sources = [name for step, text in STEPS if step == "COPY" for name in text.split()[:-1]]
    assert [name for name in sources if not (REPOSITORY / name).exists()] == []
    folders = (REPOSITORY / "src" / "opml" / name for name in ("workflow/project", "manual"))
    links = {link.name for folder in folders for link in folder.iterdir() if link.is_symlink()}
    assert {"requirements.lock", "pyproject.toml", *links} <= set(sources)


def test_the_image_installs_as_the_makefile_does_and_compiles_at_once():
    install = re.search(r"^INSTALL := \$\(BIN\)/(.*)$", MAKEFILE, re.MULTILINE)[1]
    install = install.replace(" --no-compile", "")  # who runs the image cannot write beside its modules
    recipe = re.search(r"^\$\(INSTALLED\): .*\n((?:\t.*\n)+)", MAKEFILE, re.MULTILINE)[1]
    installed = re.findall(r"^\t\$\(INSTALL\) (.*)$", recipe, re.MULTILINE)
    assert [text for step, text in STEPS if step == "RUN"] == [f"{install} {what}" for what in installed]


def test_the_image_is_of_an_exact_release_and_runs_as_nobody_in_particular():
    steps = dict(STEPS)
    assert re.fullmatch(r"python:3\.11\.\d+-slim-\w+(@sha256:[0-9a-f]{64})?", steps["FROM"])
    last, user = max((k, text) for k, (step, text) in enumerate(STEPS) if step == "USER")
    assert int(user.partition(":")[0]) >= 1000
    assert "RUN" not in [step for step, _ in STEPS[last:]]


def test_the_hosted_tests_make_targets_that_there_are():
    targets = set(re.search(r"^\.PHONY: (.*)$", MAKEFILE, re.MULTILINE)[1].split())
    once = CI["jobs"]["once"]["strategy"]["matrix"]["target"]
    assert set(once) <= targets
    commands = [step.get("run", "") for job in CI["jobs"].values() for step in job["steps"]]
    assert "make test PYTHON=python" in commands
    assert "exec make test\n" in (REPOSITORY / ".ci" / "run").read_text(encoding="utf-8")


def test_the_hosted_tests_run_every_python_that_is_promised():
    promised = [re.fullmatch(r".* (3\.\d+)", text) for text in PROJECT["classifiers"]]
    assert [found[1] for found in promised if found] == CI["jobs"]["test"]["strategy"]["matrix"]["python"]
    assert PROJECT["requires-python"] == f">={CI['jobs']['test']['strategy']['matrix']['python'][0]}"


@pytest.mark.parametrize("name", ["title", "version", "license", "keywords"])
def test_the_metadata_of_a_release_agree(name):
    citation = yaml.safe_load((REPOSITORY / "CITATION.cff").read_text(encoding="utf-8"))
    deposit = json.loads((REPOSITORY / ".zenodo.json").read_text(encoding="utf-8"))
    assert citation[name] == deposit[name]
    assert str(citation["date-released"]) == deposit["publication_date"]
    assert [author["name"] for author in citation["authors"]] == [one["name"] for one in deposit["creators"]]
