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
