# The paper's tables from what ran, and its numbers beside ours.
REPORTED = experiments.reported(config, SETTINGS.rsos)
HEADLINES = experiments.headlines(config)
COMPONENTS = experiments.all_components(config)
DATASETS = list(dict.fromkeys((one.target, one.stations) for one in EVALUATIONS.values()))
DATASETS += [(rso, one.stations) for grid in GRIDS.values() for rso, one in grid.items()]


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
    threads: 1
    resources:
        mem_mb=500,
        runtime=5,
    params:
        settings={key: config[key] for key in ("epoch", "environment", "force_models")}
        | {
            "stations": [asdict(station) for station in SETTINGS.stations.values()],
            "rso": asdict(parse_rso(ENTRIES["defaults"]["rso"], SETTINGS.rsos)),
            "rsos": [asdict(parse_rso(rso, SETTINGS.rsos)) for grid in GRIDS.values() for rso in grid],
        },
        code=code("tables.py"),
    message:
        "Tables: models, stations and RSOs, from the settings"
    script:
        "../scripts/tables.py"


rule components:
    input:
        named(rules.evaluate.output.metrics, *(one for of in COMPONENTS.values() for one in of)),
    output:
        **documents("tables/components", section=SECTIONS["numerical"]),
    log:
        f"{RESULTS}/logs/tables/components.log",
    benchmark:
        f"{RESULTS}/benchmarks/tables/components.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=500,
        runtime=5,
    params:
        settings={"epoch": config["epoch"], "evaluations": list(COMPONENTS)},
        code=code("components.py"),
    message:
        "Table: performance metric P_ML of all six components"
    script:
        "../scripts/components.py"


rule reproduction:
    input:
        metrics=named(rules.evaluate.output.metrics, *REPORTED),
        models=[named(rules.train.output[0], headline.experiment)[0] for headline in HEADLINES],
        datasets=[
            made(rules.dataset.output[0], rso=rso, stations=stations, window="", reading="")
            for rso, stations in DATASETS
        ],
        estimates=[
            made(rules.estimation.output[0], rso=rso, stations=stations, window="")
            for rso, stations in DATASETS
        ],
    output:
        **documents("reproduction", section="0 The paper's numbers and ours"),
    log:
        f"{RESULTS}/logs/reproduction.log",
    benchmark:
        f"{RESULTS}/benchmarks/reproduction.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        settings=config | {"headlines": [headline.name for headline in HEADLINES], "datasets": DATASETS},
        code=code("reproduction.py"),
    message:
        "Reproduction: the paper's numbers beside ours"
    script:
        "../scripts/reproduction.py"
