"""Run the real command line in a folder of its own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


class Project:
    """A folder with the project's config, run by the workflow of `source` (by default this tree)."""

    def __init__(self, folder: Path, source: Path = ROOT):
        self.folder, self.source = folder, source
        if not (folder / "config").exists():
            shutil.copytree(ROOT / "config", folder / "config")

    def snakemake(self, *arguments, check=True):
        """Run snakemake here; its output, both streams together, is in `.stdout`."""
        command = [sys.executable, "-m", "snakemake", "--snakefile", self.source / "Snakefile", *arguments]
        environment = os.environ | {"PYTHONPATH": str(self.source / "src"), "NO_COLOR": "1"}
        done = subprocess.run(
            [str(part) for part in command],
            cwd=self.folder,
            env=environment,
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
