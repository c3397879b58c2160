# The fits' own covariances, and whether they are true.


rule covariances:
    input:
        **ENVIRONMENT,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
    output:
        f"{RESULTS}/covariances/{{rso}}/{{stations}}{{window}}.parquet",
    log:
        f"{RESULTS}/logs/covariances/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/covariances/{{rso}}/{{stations}}{{window}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=12,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "rso": rso(wildcards),
        },
        code=code("covariances.py"),
    message:
        "Covariances: each fit's own, of {wildcards.rso} by {wildcards.stations}, carried to its predictions"
    script:
        "../scripts/covariances.py"


rule fit_calibration:
    input:
        target=rules.evaluate.input.target,
        judge=judge(rules.dataset.output[0]),
        covariances=f"{RESULTS}/covariances/{{target}}/{{stations}}{{window}}.parquet",
        asked=checked_names(split, experiment),
    output:
        f"{RESULTS}/fit_calibration/{EXPERIMENT}/{{target}}/{{test}}.parquet",
    log:
        f"{RESULTS}/logs/fit_calibration/{EXPERIMENT}/{{target}}/{{test}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/fit_calibration/{EXPERIMENT}/{{target}}/{{test}}.tsv"
    wildcard_constraints:
        test=naming.TEST_BY_ROW,
        learner="none",
        component=components.CORRECTED,
    conda:
        "../envs/opml.yaml"
    params:
        settings=tested_settings,
        code=code("fit_calibration.py"),
    message:
        "Calibration of the fits of {wildcards.target} by {wildcards.stations}, {wildcards.test}"
    script:
        "../scripts/fit_calibration.py"
