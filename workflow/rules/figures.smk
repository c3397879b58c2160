# The paper's figures, in its order.
ENTRIES = config["experiments"]
DEFAULTS = ENTRIES["defaults"]
SECTIONS = experiments.SECTIONS
EVALUATIONS = experiments.evaluations(config)
PARTITION = ENTRIES["partition"]
INDIVIDUAL = EVALUATIONS[ENTRIES["individual"]["evaluation"]]
GRIDS = {name: experiments.grid(config, name) for name in ENTRIES["grids"]}
CURVES = {name: experiments.curve(config, name, SETTINGS.rsos) for name in ENTRIES["curves"]}
KERNEL_SCALES = experiments.kernel_scales(config)
KERNEL_RULES = experiments.kernel_rules(config)


wildcard_constraints:
    ratio=r"[1-9]\d?",
    grid="|".join(GRIDS),
    curve="|".join(CURVES),


rule estimation_window:
    input:
        made(rules.tracking.output[0], **ENTRIES["defaults"]),
    output:
        **figures("estimation_window", section=SECTIONS["simulation"]),
    log:
        f"{RESULTS}/logs/figs/estimation_window.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/estimation_window.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "window_hours": config["estimation"]["window_hours"],
            "window_day": ENTRIES["orbit"]["window_day"],
        },
        code=code("estimation_window.py"),
    message:
        "Figure: the tracks that an estimate is made of"
    script:
        "../scripts/estimation_window.py"


rule orbit:
    input:
        truth=made(rules.truth.output[0], **ENTRIES["defaults"]),
        tracking=made(rules.tracking.output[0], **ENTRIES["defaults"]),
        gravity_field=ENVIRONMENT["gravity_field"],
    output:
        **figures("orbit_3d", "orbital_elements", section=SECTIONS["numerical"]),
    log:
        f"{RESULTS}/logs/figs/orbit.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/orbit.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "days": config["learning"]["span_days"],
            "zoom_days": ENTRIES["orbit"]["zoom_days"],
        },
        code=code("orbit.py"),
    message:
        "Figures: orbit in 3D with observations, osculating elements"
    script:
        "../scripts/orbit.py"


rule error_distribution:
    input:
        made(
            rules.dataset.output[0], **(ENTRIES["defaults"] | ENTRIES["distribution"]), window="", reading=""
        ),
    output:
        **figures("error_distribution_position", "error_distribution_velocity", section=SECTIONS["numerical"]),
    log:
        f"{RESULTS}/logs/figs/error_distribution.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/error_distribution.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "days": config["learning"]["span_days"],
            **ENTRIES["distribution"],
        },
        code=code("error_distribution.py"),
    message:
        "Figures: true prediction error against the prediction duration"
    script:
        "../scripts/error_distribution.py"


rule svr:
    input:
        lambda wildcards: named(rules.evaluate.output.evaluation, EVALUATIONS[wildcards.evaluation]),
    output:
        **figures(
            "{evaluation}_absolute",
            "{evaluation}_signed",
            caption="svr",
            section=lambda wildcards: EVALUATIONS[wildcards.evaluation].section,
        ),
    log:
        f"{RESULTS}/logs/figs/{{evaluation}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/{{evaluation}}.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **EVALUATIONS[wildcards.evaluation].names(),
            "published": ENTRIES["evaluations"][wildcards.evaluation].get("published"),
        },
        code=code("svr.py"),
    message:
        "Figures: errors before and after the correction, {wildcards.evaluation}"
    script:
        "../scripts/svr.py"


rule partition:
    input:
        lambda wildcards: named(
            rules.evaluate.output.evaluation, experiments.partition(config, wildcards.ratio)
        ),
    output:
        **figures("partition_{ratio}", caption="partition", section=SECTIONS["numerical"]),
    log:
        f"{RESULTS}/logs/figs/partition_{{ratio}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/partition_{{ratio}}.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **experiments.partition(config, wildcards.ratio).names(),
            "published": PARTITION["published"].get(wildcards.ratio),
        },
        code=code("error_bars.py"),
    message:
        "Figure: errors after training on {wildcards.ratio} % of the dataset"
    script:
        "../scripts/error_bars.py"


rule partition_curve:
    input:
        named(rules.evaluate.output.metrics, *experiments.partitions(config)),
    output:
        **figures("partition_curve", section=SECTIONS["numerical"]),
    log:
        f"{RESULTS}/logs/figs/partition_curve.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/partition_curve.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "component": experiments.partition(config, PARTITION["ratios"][0]).component,
            "published": PARTITION["published"],
        },
        code=code("partition_curve.py"),
    message:
        "Figure: performance metric P_ML against the size of the training data"
    script:
        "../scripts/partition_curve.py"


rule individual:
    input:
        named(rules.evaluate.output.evaluation, INDIVIDUAL),
    output:
        **figures(
            "individual_reduced",
            "individual_increased",
            "individual_distribution",
            section=SECTIONS["future"],
        ),
    log:
        f"{RESULTS}/logs/figs/individual.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/individual.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={"epoch": config["epoch"], **INDIVIDUAL.names()},
        code=code("individual.py"),
    message:
        "Figures: individual performance metric p_ML"
    script:
        "../scripts/individual.py"


rule rso_grid:
    input:
        lambda wildcards: named(rules.evaluate.output.evaluation, *GRIDS[wildcards.grid].values()),
    output:
        **figures("{grid}_grid", caption="rso_grid", section=SECTIONS["future"]),
    log:
        f"{RESULTS}/logs/figs/{{grid}}_grid.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/{{grid}}_grid.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "rsos": list(GRIDS[wildcards.grid]),
            "component": next(iter(GRIDS[wildcards.grid].values())).component,
        },
        code=code("rso_grid.py"),
    message:
        "Figure: the correction on other RSOs, {wildcards.grid}"
    script:
        "../scripts/rso_grid.py"


rule rso:
    input:
        lambda wildcards: named(rules.evaluate.output.evaluation, GRIDS[wildcards.grid][wildcards.rso]),
    output:
        **figures("{grid}_{rso}", caption="one_rso", section=SECTIONS["future"]),
    log:
        f"{RESULTS}/logs/figs/{{grid}}_{{rso}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/{{grid}}_{{rso}}.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], **GRIDS[wildcards.grid][wildcards.rso].names()},
        code=code("error_bars.py"),
    message:
        "Figure: the correction on {wildcards.rso}"
    script:
        "../scripts/error_bars.py"


rule transfer_curve:
    input:
        lambda wildcards: named(rules.evaluate.output.metrics, *CURVES[wildcards.curve]),
    output:
        **figures("{curve}_curve", caption="transfer_curve", section=SECTIONS["nearby"]),
    log:
        f"{RESULTS}/logs/figs/{{curve}}_curve.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/{{curve}}_curve.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "curve": wildcards.curve,
            "targets": experiments.targets(config, wildcards.curve, SETTINGS.rsos),
            "component": CURVES[wildcards.curve][0].component,
            "published": ENTRIES["curves"][wildcards.curve].get("published", {}),
        },
        code=code("transfer_curve.py"),
    message:
        "Figure: performance metric P_ML on nearby RSOs, {wildcards.curve}"
    script:
        "../scripts/transfer_curve.py"


rule kernel_scale_sensitivity:
    input:
        metrics=named(rules.evaluate.output.metrics, *KERNEL_SCALES),
        models=named(rules.train.output[0], *KERNEL_RULES),
    output:
        **figures("kernel_scale_sensitivity", section=SECTIONS["learning"]),
    log:
        f"{RESULTS}/logs/figs/kernel_scale_sensitivity.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/kernel_scale_sensitivity.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=700,
        runtime=5,
    params:
        settings={
            "epoch": config["epoch"],
            "scales": ENTRIES["kernel_scale"]["scales"],
            "rules": [
                [rule.stations, config["learners"][rule.learner]["kernel_scale"]] for rule in KERNEL_RULES
            ],
            "component": KERNEL_SCALES[0].component,
        },
        code=code("kernel_scale_sensitivity.py"),
    message:
        "Figure: performance metric P_ML against the kernel scale"
    script:
        "../scripts/kernel_scale_sensitivity.py"
