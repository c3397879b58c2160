# The paper's 'Estimation Models'.
ESTIMATES = product("estimates/{rso}/{stations}{window}")
FILTERED_ESTIMATES = product(f"estimates/{{rso}}/{{stations}}{naming.FILTERED}")
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
    wildcard_constraints:
        window=PLAN.window_pattern,
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


rule filter:
    input:
        **ENVIRONMENT.fits,
        estimates=at_window("", rules.estimation.output[0]),
        tracking=rules.tracking.output[0],
        check=checks(PARAMS.check_filtered),
    output:
        FILTERED_ESTIMATES.table,
    log:
        FILTERED_ESTIMATES.log,
    benchmark:
        FILTERED_ESTIMATES.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "light_time": config["estimation"].get("light_time", False),
            "rso": PARAMS.rso(wildcards),
            "stations": PARAMS.stations(wildcards),
        },
        code=code("filter.py"),
    message:
        "Sequential filter: state and drag coefficient of {wildcards.rso} after each track of {wildcards.stations}"
    script:
        "../scripts/filter.py"
