"""The Snakefiles of this tree as the Python that Snakemake makes of them, made once for all its starts."""

from io import StringIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import snakemake.workflow
from snakemake.parser import parse
from snakemake.sourcecache import LocalSourceFile

TREE = Path(__file__).parents[2]
FILES = (TREE / "Snakefile", TREE / "workflow" / "Snakefile", *(TREE / "workflow" / "rules").glob("*.smk"))


class _Parsed(NamedTuple):
    code: str
    lines: dict[int, int]  # of the code -> of the file
    rules: int


def _parsed(path: Path) -> _Parsed:
    text = StringIO(path.read_text(encoding="utf-8"))
    reader: Any = SimpleNamespace(sourcecache=SimpleNamespace(open=lambda _: text))
    lines: dict[int, int] = {}
    code, rules = parse(LocalSourceFile(str(path)), reader, lines)
    return _Parsed(code, lines, rules)


def parse_once() -> None:
    """Parse these files now, so that no start of Snakemake in a fork of this process does."""
    known = {str(path): _parsed(path) for path in FILES}

    def parse_others(file, workflow, linemap, rulecount=0):
        found = known.get(file.get_path_or_uri(secret_free=True))
        if found is None:
            return parse(file, workflow, linemap, rulecount=rulecount)
        linemap |= found.lines
        return found.code, rulecount + found.rules

    snakemake.workflow.parse = parse_others
