# Figures. The first rule draws the errors of any evaluation by its name. All others inherit its environment and its
# `script`, whose name their params give. Each part of the paper's study has its own rules.


wildcard_constraints:
    ratio=r"[1-9]\d?",
    grid=naming.alternatives(PAPER.grids),
    curve=naming.alternatives(PAPER.curves),


rule errors:
    input:
        evaluation=[rules.evaluate.output.evaluation],
        metrics=[rules.evaluate.output.metrics],
        dataset=[rules.evaluate.input.target],
    output:
        pdf=[f"{RESULTS}/figs/errors/{EXPERIMENT}/{{target}}/{{test}}.pdf"],
        png=[f"{RESULTS}/figs/errors/{EXPERIMENT}/{{target}}/{{test}}.png"],
    log:
        f"{RESULTS}/logs/figs/errors/{EXPERIMENT}/{{target}}/{{test}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/errors/{EXPERIMENT}/{{target}}/{{test}}.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        draw="error_bars",
        settings=lambda wildcards: told_of(naming.Experiment(**dict(wildcards.items()))),
        code=code("error_bars.py"),
    message:
        "Figure: errors before and after the correction of {wildcards.target} by {wildcards.learner}"
    script:
        "../scripts/{params.draw}.py"


if "orbit" in STUDY:

    use rule errors as estimation_window with:
        input:
            path_of(rules.tracking.output[0], **STUDY.defaults),
        output:
            **figures("estimation_window", section=SECTIONS["simulation"]),
        log:
            f"{RESULTS}/logs/figs/estimation_window.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/estimation_window.tsv"
        params:
            **drawing(
                "estimation_window",
                window_hours=config["estimation"]["window_hours"],
                window_day=STUDY.entry("orbit")["window_day"],
                **STUDY.defaults,
            ),
        message:
            "Figure: the tracks that an estimate is made of"

    use rule errors as orbit with:
        input:
            truth=path_of(rules.truth.output[0], **STUDY.defaults),
            tracking=path_of(rules.tracking.output[0], **STUDY.defaults),
            gravity_field=ENVIRONMENT["gravity_field"],
        output:
            **figures("orbit_3d", "orbital_elements", section=SECTIONS["numerical"]),
        log:
            f"{RESULTS}/logs/figs/orbit.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/orbit.tsv"
        params:
            **drawing(
                "orbit",
                days=STUDY.span_days,
                zoom_days=STUDY.entry("orbit")["zoom_days"],
                **STUDY.defaults,
            ),
        message:
            "Figures: orbit in 3D with observations, osculating elements"


use rule errors as world with:
    input:
        truth=rules.truth.output[0],
        tracking=rules.tracking.output[0],
        earth_orientation=ENVIRONMENT["earth_orientation"],
    output:
        **figures("maps/{rso}/{stations}", caption="world", section=SECTIONS["simulation"]),
    log:
        f"{RESULTS}/logs/figs/maps/{{rso}}/{{stations}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/maps/{{rso}}/{{stations}}.tsv"
    params:
        draw="world",
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "radars": stations(wildcards),
            "first_day": max(0, int(config["duration_days"] / 2) - 1),
            **dict(wildcards.items()),
        },
        code=code("world.py"),
    message:
        "Figure: where {wildcards.rso} flies in a day, and where {wildcards.stations} see it"


if "distribution" in STUDY:

    use rule errors as error_distribution with:
        input:
            path_of(
                rules.dataset.output[0],
                **(STUDY.defaults | dict(STUDY.entry("distribution"))),
                window="",
                reading="",
            ),
        output:
            **figures(
                "error_distribution_position", "error_distribution_velocity", section=SECTIONS["numerical"]
            ),
        log:
            f"{RESULTS}/logs/figs/error_distribution.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/error_distribution.tsv"
        params:
            **drawing(
                "error_distribution",
                days=STUDY.span_days,
                **(STUDY.defaults | dict(STUDY.entry("distribution"))),
            ),
        message:
            "Figures: true prediction error against the prediction duration"


if "evaluations" in STUDY:

    use rule errors as svr with:
        input:
            unpack(lambda wildcards: drawn_from(PAPER.evaluations[wildcards.evaluation])),
        output:
            **figures(
                "{evaluation}_absolute",
                "{evaluation}_signed",
                caption="svr",
                section=lambda wildcards: section_of(PAPER.evaluations[wildcards.evaluation]),
            ),
        log:
            f"{RESULTS}/logs/figs/{{evaluation}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/{{evaluation}}.tsv"
        params:
            draw="svr",
            settings=lambda wildcards: told_of(
                PAPER.evaluations[wildcards.evaluation],
                published=STUDY.entry("evaluations")[wildcards.evaluation].get("published"),
            ),
            code=code("svr.py"),
        message:
            "Figures: errors before and after the correction, {wildcards.evaluation}"


if "partition" in STUDY:

    use rule errors as partition with:
        input:
            unpack(lambda wildcards: drawn_from(PAPER.partition(wildcards.ratio))),
        output:
            **figures("partition_{ratio}", caption="partition", section=SECTIONS["numerical"]),
        log:
            f"{RESULTS}/logs/figs/partition_{{ratio}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/partition_{{ratio}}.tsv"
        params:
            draw="error_bars",
            settings=lambda wildcards: told_of(
                PAPER.partition(wildcards.ratio),
                published=STUDY.entry("partition").get("published", {}).get(wildcards.ratio),
            ),
            code=code("error_bars.py"),
        message:
            "Figure: errors after training on {wildcards.ratio} % of the dataset"

    use rule errors as partition_curve with:
        input:
            paths_of(rules.evaluate.output.metrics, *PAPER.partitions),
        output:
            **figures("partition_curve", section=SECTIONS["numerical"]),
        log:
            f"{RESULTS}/logs/figs/partition_curve.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/partition_curve.tsv"
        params:
            **drawing(
                "partition_curve",
                component=PAPER.partitions[0].component,
                published=STUDY.entry("partition").get("published", {}),
            ),
        message:
            "Figure: performance metric P_ML against the size of the training data"


if "individual" in STUDY:

    use rule errors as individual with:
        input:
            paths_of(rules.evaluate.output.evaluation, PAPER.individual),
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
        params:
            **drawing(
                "individual",
                **PAPER.individual.names(),
                published=next(
                    (
                        claim["limit"]
                        for claim in STUDY.entry("individual").get("claims", [])
                        if claim["holds"] == "share_of_points_near"
                    ),
                    None,
                ),
            ),
        message:
            "Figures: individual performance metric p_ML"


if "grids" in STUDY:

    use rule errors as rso_grid with:
        input:
            unpack(lambda wildcards: drawn_from(*PAPER.grids[wildcards.grid].values())),
        output:
            **figures("{grid}_grid", caption="rso_grid", section=SECTIONS["future"]),
        log:
            f"{RESULTS}/logs/figs/{{grid}}_grid.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/{{grid}}_grid.tsv"
        params:
            draw="rso_grid",
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "cleaning": dict(STUDY.entry("cleaning")),
                "experiments": [one.names() for one in PAPER.grids[wildcards.grid].values()],
                "component": next(iter(PAPER.grids[wildcards.grid].values())).component,
            },
            code=code("rso_grid.py"),
        message:
            "Figure: the correction on other RSOs, {wildcards.grid}"

    use rule errors as rso with:
        input:
            unpack(lambda wildcards: drawn_from(PAPER.grids[wildcards.grid][wildcards.rso])),
        output:
            **figures("{grid}_{rso}", caption="one_rso", section=SECTIONS["future"]),
        log:
            f"{RESULTS}/logs/figs/{{grid}}_{{rso}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/{{grid}}_{{rso}}.tsv"
        params:
            draw="error_bars",
            settings=lambda wildcards: told_of(PAPER.grids[wildcards.grid][wildcards.rso]),
            code=code("error_bars.py"),
        message:
            "Figure: the correction on {wildcards.rso}"


if "curves" in STUDY:

    use rule errors as transfer_curve with:
        input:
            lambda wildcards: paths_of(
                rules.evaluate.output.metrics, *PAPER.curves[wildcards.curve].experiments
            ),
        output:
            **figures("{curve}_curve", caption="transfer_curve", section=SECTIONS["nearby"]),
        log:
            f"{RESULTS}/logs/figs/{{curve}}_curve.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/{{curve}}_curve.tsv"
        params:
            draw="transfer_curve",
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "curve": wildcards.curve,
                "targets": PAPER.curves[wildcards.curve].targets,
                "component": PAPER.curves[wildcards.curve].experiments[0].component,
                "published": PAPER.curves[wildcards.curve].published,
            },
            code=code("transfer_curve.py"),
        message:
            "Figure: performance metric P_ML on nearby RSOs, {wildcards.curve}"


if "kernel_scale" in STUDY:

    use rule errors as kernel_scale_sensitivity with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *PAPER.kernel_scales),
            models=paths_of(rules.train.output[0], *PAPER.kernel_rules),
        output:
            **figures("kernel_scale_sensitivity", section=SECTIONS["learning"]),
        log:
            f"{RESULTS}/logs/figs/kernel_scale_sensitivity.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/kernel_scale_sensitivity.tsv"
        params:
            **drawing(
                "kernel_scale_sensitivity",
                scales=STUDY.entry("kernel_scale")["scales"],
                rules=[
                    [rule.stations, config["learners"][rule.learner]["kernel_scale"]]
                    for rule in PAPER.kernel_rules
                ],
                component=PAPER.kernel_scales[0].component,
            ),
        message:
            "Figure: performance metric P_ML against the kernel scale"


if KNOWLEDGE == knowledge.FORECAST:

    use rule errors as fan with:
        input:
            fan=rules.ensemble.output.fan,
            sample=rules.ensemble.output.sample,
        output:
            pdf=f"{RESULTS}/figs/fans/{{rso}}/{{stations}}{{window}}_n{{members}}/{{track}}.pdf",
            png=f"{RESULTS}/figs/fans/{{rso}}/{{stations}}{{window}}_n{{members}}/{{track}}.png",
        log:
            f"{RESULTS}/logs/figs/fans/{{rso}}/{{stations}}{{window}}_n{{members}}/{{track}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/fans/{{rso}}/{{stations}}{{window}}_n{{members}}/{{track}}.tsv"
        wildcard_constraints:
            members=naming.MEMBERS,
            track=naming.TRACK,
        params:
            draw="fan",
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "level": config["intervals"]["level"],
                **dict(wildcards.items()) | {"track": int(wildcards.track)},
            },
            code=code("fan.py"),
        message:
            "Figure: the prediction of {wildcards.rso} from track {wildcards.track} under {wildcards.members} futures"
