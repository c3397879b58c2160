# Beyond the paper: the causes of prediction errors that a catalogue knows.
SENSITIVITIES = product("sensitivities/{rso}/{stations}{window}")
MECHANISM = product("mechanism/{rso}/{stations}{window}")
ARCS = product("arcs/{rso}/{stations}{window}{arc}")
CD_PAST = product("cd_past/{rso}/{stations}{window}{arc}{memory}")
LONG = PLAN.window(config["mechanism"]["long_window_hours"])


rule sensitivities:
    input:
        **ENVIRONMENT.predictions,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
    output:
        SENSITIVITIES.table,
    log:
        SENSITIVITIES.log,
    benchmark:
        SENSITIVITIES.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=8,
    params:
        settings=lambda wildcards: {
            **PARAMS.assumed_model,
            "rso": PARAMS.rso(wildcards),
        },
        code=code("sensitivities.py"),
    message:
        "Sensitivities: how each prediction of {wildcards.rso} by {wildcards.stations} answers to its drag coefficient"
    script:
        "../scripts/sensitivities.py"


rule mechanism:
    input:
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        sensitivities=rules.sensitivities.output[0],
        long_estimates=at_window(LONG, rules.estimation.output[0]),
        long_predictions=at_window(LONG, rules.prediction.output[0]),
        long_sensitivities=at_window(LONG, rules.sensitivities.output[0]),
        gravity_field=GRAVITY_FIELD.table,
    output:
        MECHANISM.table,
    log:
        MECHANISM.log,
    benchmark:
        MECHANISM.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
    params:
        settings={"epoch": config["epoch"], "cd_bounds": PARAMS.cd_bounds, **config["mechanism"]},
        code=code("mechanism.py"),
    message:
        "Mechanism: sensitivities, long arcs and resonances of the predictions of {wildcards.rso} by {wildcards.stations}"
    script:
        "../scripts/mechanism.py"


rule arcs:
    input:
        **ENVIRONMENT.predictions,
        manoeuvres=INPUTS.truth_or(rules.truth.output[0], rules.tracking.output[0]),
        predictions=rules.prediction.output[0],
        arc_estimates=INPUTS.at_arc(rules.estimation.output[0]),
        arc_predictions=INPUTS.at_arc(rules.prediction.output[0]),
    output:
        ARCS.table,
    log:
        ARCS.log,
    benchmark:
        ARCS.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=8,
    params:
        settings=lambda wildcards: {
            **PARAMS.assumed_model,
            **PARAMS.arc(wildcards),
            "rso": PARAMS.rso(wildcards),
        },
        code=code("arcs.py"),
    message:
        "Arcs: what fits of {wildcards.rso} by {wildcards.stations} over another window know, {wildcards.arc}"
    script:
        "../scripts/arcs.py"


rule cd_past:
    input:
        manoeuvres=rules.arcs.input.manoeuvres,
        predictions=rules.prediction.output[0],
        arc_estimates=INPUTS.at_arc(rules.estimation.output[0]),
    output:
        CD_PAST.table,
    log:
        CD_PAST.log,
    benchmark:
        CD_PAST.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "cd": PARAMS.rso(wildcards)["cd"],
            **PARAMS.arc_with_past(wildcards),
        },
        code=code("cd_past.py"),
    message:
        "Past of Cd: its mean by fits of {wildcards.rso} by {wildcards.stations}, {wildcards.arc}{wildcards.memory}"
    script:
        "../scripts/cd_past.py"
