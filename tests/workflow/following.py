"""Follow a page of docs/: save the files that it shows, run the commands that it gives."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from project import HUNG, ROOT, Project

SNAKEMAKE = ".venv/bin/snakemake "

REAL_RUN = "snakemake -j"
"""What stands in commands that take minutes."""


def page(name):
    """The text of docs/<name>.md."""
    return (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")


def blocks(text):
    """Kind and text of the blocks that are files (yaml) or commands (sh), in their order."""
    return re.findall(r"^```(yaml|sh)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def files(blocks):
    """The files of a page by the name in their first line."""
    return {text.split()[1]: text for kind, text in blocks if kind == "yaml"}


def plans(told):
    """The plans of the dry runs, by the command."""
    return {text: printed for text, printed in told.items() if " -n " in text}


def commands(text):
    """The commands of a block in their order: each start of Snakemake alone, others together."""
    pattern = rf"^{SNAKEMAKE}.*\n|(?:^(?!{SNAKEMAKE}).*\n)+"
    return re.findall(pattern, text.replace("\\\n", ""), re.MULTILINE)


class Reader:
    """Somebody who follows the page in a folder with the project's config."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.project = Project(folder)
        opml = folder / ".venv" / "bin" / "opml"
        opml.parent.mkdir(parents=True)
        opml.write_text(f'#!/bin/sh\nexec {shlex.join([sys.executable, "-m", "opml"])} "$@"\n')
        opml.chmod(0o755)

    def save(self, text):
        """Save a file of the page under the name in its first line."""
        (self.folder / text.split()[1]).write_text(text)

    def run(self, text):
        """Run commands as they stand; returns what they print."""
        return "".join(map(self._run, commands(text)))

    def _run(self, text):
        if text.startswith(SNAKEMAKE):
            _, *arguments = shlex.split(text)
            return self.project.snakemake(*arguments).stdout
        done = subprocess.run(
            ["bash", "-e", "-c", text],
            cwd=self.folder,
            env=os.environ | {"PYTHONPATH": str(ROOT / "src"), "NO_COLOR": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=HUNG,
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}"
        return done.stdout
