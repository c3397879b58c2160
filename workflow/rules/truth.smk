# The paper's 'Truth Dynamic Models'.


rule truth:
    input:
        **TRUE_ENVIRONMENT,
        asked=checked_names(rso, simulated),
    output:
        f"{RESULTS}/truth/{{rso}}.parquet",
    log:
        f"{RESULTS}/logs/truth/{{rso}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/truth/{{rso}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=6,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "duration_days": config["duration_days"],
            "step_s": config["tracking"]["step_s"],
            "force_model": config["force_models"]["truth"],
            "integrator": config["integrator"],
            "rso": rso(wildcards),
        },
        code=code("truth.py"),
    message:
        "Truth dynamic model: the true orbit of {wildcards.rso}"
    script:
        "../scripts/truth.py"


if CATALOGUE:

    rule truths:
        input:
            **TRUE_ENVIRONMENT,
        output:
            [f"{RESULTS}/truth/{name}.parquet" for name in CATALOGUE],
        log:
            f"{RESULTS}/logs/truth/catalogue.log",
        benchmark:
            f"{RESULTS}/benchmarks/truth/catalogue.tsv"
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=3000,
            runtime=20,
        params:
            settings={
                "epoch": config["epoch"],
                "duration_days": config["duration_days"],
                "step_s": config["tracking"]["step_s"],
                "force_model": config["force_models"]["truth"],
                "integrator": config["integrator"],
                "rsos": [asdict(sheets.parse_rso(name, SETTINGS.rsos)) for name in CATALOGUE],
            },
            code=code("truths.py"),
        message:
            "Truth dynamic model: the true orbits of a catalogue"
        script:
            "../scripts/truths.py"

    ruleorder: truths > truth
