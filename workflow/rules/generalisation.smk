# Beyond the paper: models against splits that nothing leaks across, other RSOs, intervals, and what is left.
BEYOND = experiments.SECTIONS["beyond"]
STATION_SETS = ENTRIES["generalisation"]["station_sets"]
AGAINST_SPLITS = generalisation.splits(config)
TRANSFERS = generalisation.transfers(config, SETTINGS.rsos)
INTERVALS = generalisation.intervals(config)
SHOWN_INTERVALS = {
    learner: INTERVALS[STATION_SETS[-1], learner, ENTRIES["generalisation"]["intervals"]["splits"][0]]
    for learner in ENTRIES["generalisation"]["intervals"]["learners"]
}


rule generalisation:
    input:
        metrics=named(rules.evaluate.output.metrics, *generalisation.every(config, SETTINGS.rsos)),
        coverage=named(rules.intervals.output.coverage, *INTERVALS.values()),
        datasets=[
            made(rules.dataset.output[0], rso=DEFAULTS["rso"], stations=stations, window="", reading="")
            for stations in STATION_SETS
        ],
        oracles=[
            made(rules.oracle.output[0], rso=DEFAULTS["rso"], stations=stations) for stations in STATION_SETS
        ],
    output:
        **documents("generalisation", section=BEYOND),
    log:
        f"{RESULTS}/logs/generalisation.log",
    benchmark:
        f"{RESULTS}/benchmarks/generalisation.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=5,
    params:
        settings=config,
        code=code("generalisation.py"),
    message:
        "Generalisation: models against splits, with baselines and intervals"
    script:
        "../scripts/generalisation.py"


rule generalisation_splits:
    input:
        named(rules.evaluate.output.metrics, *AGAINST_SPLITS.values()),
    output:
        **figures("generalisation", section=BEYOND),
    log:
        f"{RESULTS}/logs/figs/generalisation.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/generalisation.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "component": DEFAULTS["component"],
            "published": published(AGAINST_SPLITS),
            **{key: ENTRIES["generalisation"][key] for key in ("station_sets", "learners", "splits")},
        },
        code=code("generalisation_splits.py"),
    message:
        "Figure: performance metric P_ML of models against splits"
    script:
        "../scripts/generalisation_splits.py"


rule generalisation_transfers:
    input:
        named(rules.evaluate.output.metrics, *TRANSFERS.values()),
    output:
        **figures("generalisation_transfers", section=BEYOND),
    log:
        f"{RESULTS}/logs/figs/generalisation_transfers.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/generalisation_transfers.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "component": DEFAULTS["component"],
            "published": published(TRANSFERS),
            "curves": {curve: experiments.targets(config, curve, SETTINGS.rsos) for curve in CURVES},
        },
        code=code("generalisation_transfers.py"),
    message:
        "Figure: performance metric P_ML of models on nearby RSOs"
    script:
        "../scripts/generalisation_transfers.py"


rule generalisation_intervals:
    input:
        named(rules.intervals.output.intervals, *SHOWN_INTERVALS.values()),
    output:
        **figures("generalisation_intervals", section=BEYOND),
    log:
        f"{RESULTS}/logs/figs/generalisation_intervals.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/generalisation_intervals.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "component": DEFAULTS["component"],
            "level": config["intervals"]["level"],
            "learners": list(SHOWN_INTERVALS),
        },
        code=code("generalisation_intervals.py"),
    message:
        "Figure: prediction intervals"
    script:
        "../scripts/generalisation_intervals.py"
