"""The source as the linters, the rules of the house and the pins would have it."""

import re
import subprocess
import sys
import tomllib
from importlib.metadata import distributions

import pytest
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name
from support import REPOSITORY

PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]


def run(*command):
    return subprocess.run(
        command, cwd=REPOSITORY, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ["-m", "snakemake", "--lint"],
        ["-m", "ruff", "check"],
        ["-m", "snakefmt", "--check", "Snakefile", "workflow"],
        ["-m", "mypy"],
    ],
    ids=["rules", "style", "style of rules", "types"],
)
def test_linters_are_content(command):
    done = run(sys.executable, *command)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_imports_run_downwards():
    done = run(
        sys.executable, "-c", "from importlinter.cli import lint_imports_command; lint_imports_command()"
    )
    assert done.returncode == 0, done.stdout


def test_every_rule_has_log_benchmark_message_and_code():
    for path in (REPOSITORY / "workflow" / "rules").glob("*.smk"):
        for rule in re.split(r"^ *(?:use )?rule ", path.read_text(), flags=re.MULTILINE)[1:]:
            missing = [part for part in ("log:", "benchmark:", "message:") if part not in rule]
            assert not missing, f"{path.name}: {rule.split(':')[0]}: {missing}"
            assert re.search(r"code=code|\*\*drawing\(", rule), f"{path.name}: {rule.split(':')[0]}"


def test_scripts_are_short():
    for path in (REPOSITORY / "workflow" / "scripts").glob("*.py"):
        _, job = path.read_text().split("with job(")  # after the settings that it takes
        assert len(job.splitlines()) <= 25, path.name


def pins_of(lock):
    """Versions by the name of the package, in a file of pins."""
    return dict(re.findall(r"^([\w.-]+)==([^\s;]+)", (REPOSITORY / lock).read_text(), re.MULTILINE))


def test_one_set_of_pins():
    pins = pins_of("requirements.lock")
    extras = PROJECT["optional-dependencies"]
    needed = [*PROJECT["dependencies"], *extras["workflow"]]
    wanted = [*needed, *extras["test"]]
    assert {re.match(r"[\w-]+", text)[0] for text in wanted} <= set(pins)
    conda = (REPOSITORY / "workflow" / "envs" / "opml.yaml").read_text()
    conda_pins = dict(re.findall(r"- ([\w-]+)==(\S+)", conda))
    assert {re.match(r"[\w-]+", text)[0] for text in needed} <= set(conda_pins)
    assert conda_pins.items() <= pins.items()


@pytest.mark.parametrize("lock", [path.name for path in REPOSITORY.glob("requirements*.lock")])
def test_nothing_is_installed_but_what_was_looked_at(lock):
    """Each pin has the digests of its files: installers then refuse others, and packages without a pin."""
    text = re.sub(r"^#.*\n", "", (REPOSITORY / lock).read_text(), flags=re.MULTILINE)
    pins = re.split(r"\n(?=\S)", text.strip())
    pinned = re.compile(r"[\w.-]+==[^\n]+?( \\\n    --hash=sha256:[0-9a-f]{64})+")
    assert [pin for pin in pins if not pinned.fullmatch(pin)] == []


@pytest.mark.parametrize("lock", ["requirements.lock", "requirements-docs.lock"])
def test_pins_are_for_the_first_release_of_the_oldest_python(lock):
    oldest = PROJECT["requires-python"].removeprefix(">=") + ".0"
    known = {
        canonicalize_name(package.name): package.metadata["Requires-Python"] for package in distributions()
    }
    wanted = {name: known.get(name) or "" for name in pins_of(lock)}  # of those that are installed
    assert {name for name, versions in wanted.items() if oldest not in SpecifierSet(versions)} == set()
