# Every morning of every object that was measured: `opml day`. What a morning left is never made again, whatever
# has changed since: its inputs count as older than it.
OBJECTS = product("days/{date}/objects_{batch}")
DAY = product("days/{date}/day")

if PLAN.watched:

    rule mornings:
        input:
            **{f"fits_{name}": ancient(path) for name, path in ENVIRONMENT.fits.items()},
            **{f"predictions_{name}": ancient(path) for name, path in ENVIRONMENT.predictions.items()},
            futures=ancient(ENVIRONMENT.futures(config["uncertainty"]["futures"])),
        output:
            OBJECTS.file("json"),
        log:
            OBJECTS.log,
        benchmark:
            OBJECTS.benchmark
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=1750,
            runtime=15,
        params:
            settings=PARAMS.mornings_of,
            code=code("mornings.py"),
        message:
            "Mornings: objects of batch {wildcards.batch} up to {wildcards.date}"
        script:
            "../scripts/mornings.py"

    use rule errors as day with:
        input:
            lambda wildcards: [
                OBJECTS.file("json").format(date=wildcards.date, batch=batch) for batch in PLAN.watched
            ],
        output:
            **{suffix: DAY.file(suffix) for suffix in ("md", "tsv", "html", "json")},
        log:
            DAY.log,
        benchmark:
            DAY.benchmark
        params:
            **drawing("day", lambda wildcards: {"epoch": config["epoch"], "date": wildcards.date}),
        message:
            "The page of {wildcards.date}"
