"""What the tests reached is told briefly, and too little of it fails."""

import subprocess
import sys

import pytest
from support import REPOSITORY

FILES = {
    "all.py": "x = 1\n",
    "most.py": 9 * "x = 1\n",
    "half.py": "x = 0\nif x:\n    y = 1\n    z = 1\n",
}


@pytest.fixture
def reached(tmp_path):
    """Run the files with a share asked of them, and tell what was reached: exit code and lines."""

    def tell(least):
        settings = f"[tool.coverage.report]\nfail_under = {least}\n[tool.coverage.run]\nsource = ['.']\n"
        (tmp_path / "pyproject.toml").write_text(settings)
        for name, text in FILES.items():
            (tmp_path / name).write_text(text)
        (tmp_path / "run.py").write_text("import all, most, half\n")
        for command in (["-m", "coverage", "run", "run.py"], [REPOSITORY / "tests" / "reached.py"]):
            done = subprocess.run([sys.executable, *command], cwd=tmp_path, capture_output=True, text=True)
        return done.returncode, done.stdout.splitlines()

    return tell


def test_the_total_and_the_files_below_the_share_are_told(reached):
    code, lines = reached(80)
    assert code == 0
    assert [line.split()[0] for line in lines] == ["Name", "half.py", "TOTAL"]


def test_a_total_below_the_share_fails(reached):
    code, lines = reached(90)
    assert code == 1
    assert lines[-1] == "expected tests that reach 90 % of the package, got 86.7 %"
