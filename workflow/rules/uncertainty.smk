# The covariances of the fits, and whether they are true.
from opml.learning.data import error_components

COVARIANCES = product("covariances/{rso}/{stations}{window}")
TARGET_COVARIANCES = product("covariances/{target}/{stations}{window}")
FIT_CALIBRATION = product(f"fit_calibration/{TEST}")


rule covariances:
    input:
        **ENVIRONMENT.predictions,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
    output:
        COVARIANCES.table,
    log:
        COVARIANCES.log,
    benchmark:
        COVARIANCES.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=12,
    params:
        settings=lambda wildcards: PARAMS.assumed_model | {"rso": PARAMS.rso(wildcards)},
        code=code("covariances.py"),
    message:
        "Covariances: each fit's own, of {wildcards.rso} by {wildcards.stations}, carried to its predictions"
    script:
        "../scripts/covariances.py"


rule fit_calibration:
    input:
        target=rules.evaluate.input.target,
        judge=INPUTS.true_errors(rules.dataset.output[0]),
        covariances=TARGET_COVARIANCES.table,
        check=checks(PARAMS.split, PARAMS.experiment),
    output:
        FIT_CALIBRATION.table,
    log:
        FIT_CALIBRATION.log,
    benchmark:
        FIT_CALIBRATION.benchmark
    wildcard_constraints:
        test=naming.TEST_BY_ROW,
        learner=error_components.UNCORRECTED,
        component=error_components.CORRECTED,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            **PARAMS.training(wildcards),
            "max_days": config["prediction"]["max_days"],
            "experiment": PARAMS.experiment(wildcards),
        },
        code=code("fit_calibration.py"),
    message:
        "Calibration of the fits of {wildcards.target} by {wildcards.stations}, {wildcards.test}"
    script:
        "../scripts/fit_calibration.py"
