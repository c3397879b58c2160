"""Run the real command line in a folder of its own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def command(*arguments, source: Path = ROOT) -> list[str]:
    """The command that starts the workflow of a tree."""
    parts = [sys.executable, "-m", "snakemake", "--snakefile", source / "Snakefile", *arguments]
    return [str(part) for part in parts]


class Project:
    """A folder with the project's config, run by the workflow of `source` (by default this tree)."""

    def __init__(self, folder: Path, source: Path = ROOT):
        self.folder, self.source = folder, source
        if not (folder / "config").exists():
            shutil.copytree(ROOT / "config", folder / "config")

    def snakemake(self, *arguments, check=True):
        """Run snakemake here; its output, both streams together, is in `.stdout`."""
        done = subprocess.run(
            command(*arguments, source=self.source),
            cwd=self.folder,
            env=os.environ | {"PYTHONPATH": str(self.source / "src"), "NO_COLOR": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=900,
        )
        if check:
            assert done.returncode == 0, done.stdout
        return done

    def products(self):
        """Path -> bytes of all results but logs and benchmarks, which hold times."""
        results = self.folder / "results"
        return {
            str(path.relative_to(results)): path.read_bytes()
            for path in sorted(results.rglob("*"))
            if path.is_file() and not {"logs", "benchmarks"} & set(path.parts)
        }
