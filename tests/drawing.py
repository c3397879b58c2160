"""What is asked of every figure: all of it inside of its page, and the same bytes from any process."""

import os
import subprocess
import sys

from opml.figures import style

PROGRAM = """
import sys, importlib, pandas as pd
from opml.figures import style
folder, module, *names = sys.argv[1:]
table = pd.read_json(f"{folder}/table.json", precise_float=True)
for name in names:
    draw = getattr(importlib.import_module(module), name)
    style.save(draw(table), f"{folder}/b_{name}.pdf", f"{folder}/b_{name}.png")
"""


def assert_inside(figure):
    """Assert that nothing of a figure is clipped by its edges."""
    figure.draw_without_rendering()
    box = figure.get_tightbbox()  # inches
    assert min(box.x0, box.y0) >= 0.0
    assert box.x1 <= figure.get_figwidth()
    assert box.y1 <= figure.get_figheight()


def assert_same_in_another_process(draws, table, folder):
    """Assert that functions of one module draw a table to the same bytes elsewhere, too."""
    for draw in draws:
        style.save(draw(table), folder / f"a_{draw.__name__}.pdf", folder / f"a_{draw.__name__}.png")
    table.to_json(folder / "table.json", double_precision=15)
    names = [draw.__name__ for draw in draws]
    environment = os.environ | {"PYTHONHASHSEED": "7", "TZ": "Asia/Tokyo", "SOURCE_DATE_EPOCH": "1"}
    command = [sys.executable, "-c", PROGRAM, str(folder), draws[0].__module__, *names]
    subprocess.run(command, check=True, env=environment)
    for name in names:
        for kind in ("pdf", "png"):
            ours, theirs = (folder / f"{run}_{name}.{kind}" for run in "ab")
            assert ours.read_bytes() == theirs.read_bytes()
