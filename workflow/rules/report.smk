# The paper's tables from what ran, and its numbers beside ours.


rule tables:
    output:
        **documents(
            "tables/models", "tables/stations", "tables/rso", "tables/rsos", section=SECTIONS["simulation"]
        ),
    log:
        f"{RESULTS}/logs/tables/settings.log",
    benchmark:
        f"{RESULTS}/benchmarks/tables/settings.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings={key: config[key] for key in ("epoch", "environment", "force_models")}
        | {
            "stations": [asdict(station) for station in SETTINGS.stations.values()],
            "rso": asdict(sheets.parse_rso(STUDY.defaults["rso"], SETTINGS.rsos)),
            "rsos": [
                asdict(sheets.parse_rso(rso, SETTINGS.rsos)) for grid in PAPER.grids.values() for rso in grid
            ],
        },
        code=code("tables.py"),
    message:
        "Tables: models, stations and RSOs, from the settings"
    script:
        "../scripts/tables.py"


if "components" in STUDY:

    use rule errors as components with:
        input:
            paths_of(
                rules.evaluate.output.metrics, *(one for own in PAPER.components.values() for one in own)
            ),
        output:
            **documents("tables/components", section=SECTIONS["numerical"]),
        log:
            f"{RESULTS}/logs/tables/components.log",
        benchmark:
            f"{RESULTS}/benchmarks/tables/components.tsv"
        params:
            **drawing("components", evaluations=list(PAPER.components)),
        message:
            "Table: performance metric P_ML of all six components"


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
            **documents("reproduction", section="0 The paper's numbers and ours"),
        log:
            f"{RESULTS}/logs/reproduction.log",
        benchmark:
            f"{RESULTS}/benchmarks/reproduction.tsv"
        resources:
            mem_mb=1000,
            runtime=5,
        params:
            draw="reproduction",
            settings=config,
            code=code("reproduction.py"),
        message:
            "Reproduction: the paper's numbers beside ours"
