"""Plan a run and hold the settings of every job against those that its script declares; print both."""

import json
import re
from pathlib import Path

import snakemake.cli
from snakemake.dag import DAG

SCRIPTS = Path(__file__).parents[2] / "workflow" / "scripts"


def declared(script: Path):
    """What a script makes of its settings: its own `Settings`, or those that it names; None for a study."""
    head, _, body = script.read_text(encoding="utf-8").partition("with job(snakemake)")
    names = re.findall(r"(\w+)\(\*\*(?:snakemake|given)\b", body)
    module = {"__name__": script.stem}
    exec(compile(head.replace('if __name__ == "__main__":', ""), script, "exec"), module)
    return module[names[0]] if names else None


def refused(job) -> str:
    """Why a script would refuse the settings of its job; '' where it takes them."""
    settings, name = job.params.settings, script_of(job)
    if (model := declared(SCRIPTS / f"{name}.py")) is None:
        return ""
    try:
        json.dumps(settings)  # of which tables hold a digest
        model(**settings, **({"rso": settings["rsos"][0]} if name == "truths" else {}))
    except (TypeError, ValueError) as error:
        return str(error)
    return ""


def script_of(job) -> str:
    return job.params.get("draw") or Path(str(job.rule.script)).stem


def tell(dag) -> None:
    jobs = {script_of(job): job for job in dag.jobs if job.rule.script}
    print(json.dumps({name: refused(job) for name, job in jobs.items()}))


def main() -> None:
    """Plan what the command line asks for."""
    stats = DAG.stats
    DAG.stats = lambda dag, *given, **options: (tell(dag), stats(dag, *given, **options))[1]
    snakemake.cli.main()
