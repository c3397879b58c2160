"""Whether the real command line refuses what it should: one clear line, exit code not 0, nothing made."""

import os
import shutil
from concurrent.futures import ThreadPoolExecutor


def amiss(cases, tell, tmp_path):
    """Try every case in a folder of its own; returns what is amiss with some.

    `tell(folder, case)` gives the finished command and how the line should begin.
    """

    def try_one(numbered):
        number, case = numbered
        folder = tmp_path / str(number)
        folder.mkdir()
        found = wrong(*tell(folder, case))
        left = (folder / "results").exists()
        shutil.rmtree(folder)
        told = found or ("left something behind" if left else None)
        return told and f"{case}: {told}"

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [found for found in pool.map(try_one, enumerate(cases)) if found]


def wrong(done, beginning):
    """What is amiss with a refusal, nothing if all is well."""
    lines = [line for line in done.stdout.splitlines() if line.startswith("opml: ")]
    if done.returncode == 0:
        return "taken"
    if "Traceback" in done.stdout or len(lines) != 1 or not lines[0].startswith(beginning):
        return done.stdout
    return None
