# The paper's tables with the settings of the run, and its numbers beside ours.
TABLES = product("tables/settings")
REPRODUCTION = product("reproduction")


rule tables:
    output:
        **documents(
            product("tables/models"),
            product("tables/stations"),
            product("tables/rso"),
            product("tables/rsos"),
            section=SECTIONS["simulation"],
        ),
    log:
        TABLES.log,
    benchmark:
        TABLES.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings={
            **{key: config[key] for key in ("epoch", "environment", "force_models")},
            "stations": PARAMS.all_stations,
            "rso": PARAMS.rso_named(STUDY.defaults["rso"]),
            "rsos": [PARAMS.rso_named(rso) for grid in PAPER.grids.values() for rso in grid],
        },
        code=code("tables.py"),
    message:
        "Tables: models, stations and RSOs, from the settings"
    script:
        "../scripts/tables.py"


if "reproduction" in STUDY:

    use rule errors as reproduction with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *PAPER.reported),
            models=[paths_of(rules.train.output[0], headline.experiment)[0] for headline in PAPER.headlines],
            datasets=[
                path_of(rules.dataset.output[0], rso=rso, stations=stations, window="", reading="")
                for rso, stations in PAPER.datasets
            ],
            estimates=[
                path_of(rules.estimation.output[0], rso=rso, stations=stations, window="")
                for rso, stations in PAPER.datasets
            ],
        output:
            **documents(REPRODUCTION, section="0 The paper's numbers and ours"),
        log:
            REPRODUCTION.log,
        benchmark:
            REPRODUCTION.benchmark
        resources:
            mem_mb=1000,
            runtime=5,
        params:
            **drawing("reproduction", config),
        message:
            "Reproduction: the paper's numbers and ours"
