# Every morning of every object that was measured: `opml day`. What a morning left is never made again, whatever
# has changed since: the job sees to it, as each day brings another table of the weather.
OBJECTS = product("days/{date}/objects_{batch}")
DAY = product("days/{date}/day")

if PLAN.watched:

    rule mornings:
        input:
            **{f"fits_{name}": path for name, path in ENVIRONMENT.fits.items()},
            **{f"predictions_{name}": path for name, path in ENVIRONMENT.predictions.items()},
            futures=ENVIRONMENT.futures(PLAN.settings.day.futures),
        output:
            OBJECTS.file("json"),
        log:
            OBJECTS.log,
        benchmark:
            OBJECTS.benchmark
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=2500,
            runtime=20,
        params:
            settings=PARAMS.mornings_of,
            code=code("mornings.py"),
        message:
            "Mornings: objects of batch {wildcards.batch} up to {wildcards.date}"
        script:
            "../scripts/mornings.py"

    use rule errors as day with:
        input:
            objects=lambda wildcards: [
                OBJECTS.file("json").format(date=wildcards.date, batch=batch) for batch in PLAN.watched
            ],
            activity=ENVIRONMENT.predictions["solar_activity"],
            outlooks=ENVIRONMENT.predictions.get("outlooks", []),
            futures=ENVIRONMENT.futures(PLAN.settings.day.futures),
        output:
            **{suffix: DAY.file(suffix) for suffix in ("md", "tsv", "html", "json")},
        log:
            DAY.log,
        benchmark:
            DAY.benchmark
        params:
            **drawing("day", PARAMS.page_of_day),
        message:
            "The page of {wildcards.date}"
