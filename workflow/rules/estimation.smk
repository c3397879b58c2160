# The paper's 'Estimation Models'.
ESTIMATES = product("estimates/{rso}/{stations}{window}")
# Fits start from the truth, or from the first orbit of what was measured.
STARTS = rules.truth.output[0]
if PLAN.settings.measured:
    STARTS = INPUTS.truth_or(rules.truth.output[0], rules.first_orbit.output[0])


rule estimation:
    input:
        **ENVIRONMENT.fits,
        start=STARTS,
        tracking=rules.tracking.output[0],
    output:
        ESTIMATES.table,
    log:
        ESTIMATES.log,
    benchmark:
        ESTIMATES.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "seed": PARAMS.noise_seed(wildcards),
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "estimation": PARAMS.estimation(wildcards),
            "rso": PARAMS.rso(wildcards),
            "stations": PARAMS.stations(wildcards),
        },
        code=code("estimation.py"),
    message:
        "Estimation models: state and drag coefficient of {wildcards.rso} at each track of {wildcards.stations}"
    script:
        "../scripts/estimation.py"
