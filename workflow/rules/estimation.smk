# The paper's 'Estimation Models'.


rule estimation:
    input:
        **FIT_ENVIRONMENT,
        start=first_states,
        tracking=rules.tracking.output[0],
    output:
        f"{RESULTS}/estimates/{{rso}}/{{stations}}{{window}}.parquet",
    log:
        f"{RESULTS}/logs/estimates/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/estimates/{{rso}}/{{stations}}{{window}}.tsv"
    wildcard_constraints:
        window=f"(?:{WINDOW}|{naming.BOTH_SIDES})",
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "seed": noise_seed(wildcards),
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "estimation": config["estimation"]
            | {
                "window_hours": window_hours(wildcards),
                "cd_bounds": cd_bounds(),
            }
            | after_hours(wildcards)
            | naming.parse_fit(wildcards.window),
            "rso": rso(wildcards),
            "stations": stations(wildcards),
        },
        code=code("estimation.py"),
    message:
        "Estimation models: state and drag coefficient of {wildcards.rso} at each track of {wildcards.stations}"
    script:
        "../scripts/estimation.py"
