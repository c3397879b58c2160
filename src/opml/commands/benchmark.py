"""Commands of the benchmark: tasks, their truth, answers and scores."""

import argparse

from opml.base.files import check_distinct_files, suffix_of
from opml.base.progress import on_stderr


def add_task(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `task`."""
    parser.add_argument("recipe", help="a recipe, as benchmark/altimetry.yaml")
    parser.add_argument(
        "orbits", nargs="*", help="files and folders of TLEs; of tracks {orbit} (the recipe's, fetched)"
    )
    parser.add_argument("-o", "--output", required=True, help="the task's folder; the truth gets -truth")
    parser.add_argument("--weather", default="OBSERVED", help="space weather, CSSI (that of the package)")


def task(options: argparse.Namespace) -> None:
    """Make a task and its truth."""
    from opml.benchmark import recipes, task_folders

    folders = task_folders.Folders.of(options.output)
    with on_stderr() as say:
        say("makes questions and truth, some minutes")
        count = recipes.make(recipes.read(options.recipe), options.orbits, folders, options.weather)
    print(f"{options.output}: {count} questions; {folders.truth_in_words}")


def add_truth(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `truth`."""
    parser.add_argument("task", help="the folder of a hidden task; its truth gets -truth")
    parser.add_argument("sets", nargs="+", help="files and folders of TLEs that were published since")


def truth(options: argparse.Namespace) -> None:
    """Make the truth of a hidden task."""
    from opml.benchmark import recipes, task_folders

    folders = task_folders.Folders.of(options.task)
    print(f"{folders.truth}: the truth of {recipes.make_truth(folders, options.sets)} questions")


def add_answer(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `answer`."""
    parser.add_argument("task", help="a task's folder, or SAMPLE")
    parser.add_argument("way", help="predict, sgp4, density, improve or learned")
    parser.add_argument("-o", "--output", required=True, help="the answers, .csv")
    parser.add_argument("--model", help="a model of `opml train` (that of the package)")


def answer(options: argparse.Namespace) -> None:
    """Write the answers of a baseline."""
    from opml.benchmark import baselines, tasks

    with on_stderr() as say:
        count = baselines.write(options.output, tasks.read(options.task), options.way, options.model, say)
    print(f"{options.output}: {count} answers")


def add_score(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `score`."""
    parser.add_argument("task", help="a task's folder, or SAMPLE")
    parser.add_argument("answers", help="a CSV or OEM, or a folder of them")
    parser.add_argument("--truth", help="folder of the truth (the task's name with -truth)")
    parser.add_argument("-o", "--output", action="append", default=[], help=".html, .json or .tsv (a line)")


def score(options: argparse.Namespace) -> None:
    """Score answers, print and write what they are worth."""
    from opml.report import benchmark

    for path in options.output:
        suffix_of(path, benchmark.SUFFIXES)
    check_distinct_files(options.output, [options.answers])
    scored = benchmark.score(options.task, options.answers, options.truth)
    for path in options.output:
        benchmark.write(path, scored)
    print(benchmark.text(scored))
