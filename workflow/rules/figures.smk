# Figures. The first rule draws the errors of any evaluation by its name. All others inherit its environment and
# its `script`, whose name their params give. Each part of the paper's study has its own rules.
ERRORS = product(f"figs/errors/{TEST}")
ESTIMATION_WINDOW = product("figs/estimation_window")
ORBIT = product("figs/orbit")
ERROR_DISTRIBUTION = product("figs/error_distribution")
SVR = product("figs/{evaluation}")
PARTITION = product("figs/partition_{ratio}")
PARTITION_CURVE = product("figs/partition_curve")
INDIVIDUAL = product("figs/individual")
RSO_GRID = product("figs/{grid}_grid")
TRANSFER_CURVE = product("figs/{curve}_curve")

ERROR_TABLES = {
    "evaluation": rules.evaluate.output.evaluation,
    "metrics": rules.evaluate.output.metrics,
    "dataset": rules.evaluate.input.target,
}


rule errors:
    input:
        **{name: [pattern] for name, pattern in ERROR_TABLES.items()},
    output:
        pdf=[ERRORS.file("pdf")],
        png=[ERRORS.file("png")],
    log:
        ERRORS.log,
    benchmark:
        ERRORS.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        **drawing(
            "error_bars",
            lambda wildcards: PARAMS.errors(naming.Experiment(**dict(wildcards.items()))),
        ),
    message:
        "Figure: errors before and after the correction of {wildcards.target} by {wildcards.learner}"
    script:
        "../scripts/{params.draw}.py"


if "orbit" in STUDY:

    use rule errors as estimation_window with:
        input:
            path_of(rules.tracking.output[0], **STUDY.defaults),
        output:
            **figures(ESTIMATION_WINDOW, section=SECTIONS["simulation"]),
        log:
            ESTIMATION_WINDOW.log,
        benchmark:
            ESTIMATION_WINDOW.benchmark
        params:
            **drawing(
                "estimation_window",
                {
                    "epoch": config["epoch"],
                    "window_hours": config["estimation"]["window_hours"],
                    "window_day": STUDY.entry("orbit")["window_day"],
                    **STUDY.defaults,
                },
            ),
        message:
            "Figure: the tracks that an estimate is made of"

    use rule errors as orbit with:
        input:
            truth=path_of(rules.truth.output[0], **STUDY.defaults),
            tracking=path_of(rules.tracking.output[0], **STUDY.defaults),
            gravity_field=GRAVITY_FIELD.table,
        output:
            **figures(
                product("figs/orbit_3d"), product("figs/orbital_elements"), section=SECTIONS["numerical"]
            ),
        log:
            ORBIT.log,
        benchmark:
            ORBIT.benchmark
        params:
            **drawing(
                "orbit",
                {
                    "epoch": config["epoch"],
                    "days": STUDY.span_days,
                    "zoom_days": STUDY.entry("orbit")["zoom_days"],
                    **STUDY.defaults,
                },
            ),
        message:
            "Figures: orbit in 3D with observations, osculating elements"


if "distribution" in STUDY:

    use rule errors as error_distribution with:
        input:
            path_of(
                rules.dataset.output[0],
                **(STUDY.defaults | {"stations": STUDY.entry("distribution")}),
                window="",
                reading="",
            ),
        output:
            **figures(
                product("figs/error_distribution_position"),
                product("figs/error_distribution_velocity"),
                section=SECTIONS["numerical"],
            ),
        log:
            ERROR_DISTRIBUTION.log,
        benchmark:
            ERROR_DISTRIBUTION.benchmark
        params:
            **drawing(
                "error_distribution",
                {
                    "epoch": config["epoch"],
                    "days": STUDY.span_days,
                    **(STUDY.defaults | {"stations": STUDY.entry("distribution")}),
                },
            ),
        message:
            "Figures: true prediction error against the prediction duration"


if "evaluations" in STUDY:

    use rule errors as svr with:
        input:
            unpack(lambda wildcards: tables_of(ERROR_TABLES, PAPER.evaluations[wildcards.evaluation])),
        output:
            **figures(
                product("figs/{evaluation}_absolute"),
                product("figs/{evaluation}_signed"),
                caption="svr",
                section=lambda wildcards: section_of(PAPER.evaluations[wildcards.evaluation]),
            ),
        log:
            SVR.log,
        benchmark:
            SVR.benchmark
        params:
            **drawing(
                "svr",
                lambda wildcards: PARAMS.errors(
                    PAPER.evaluations[wildcards.evaluation],
                    published=STUDY.entry("evaluations")[wildcards.evaluation].get("published"),
                ),
            ),
        message:
            "Figures: errors before and after the correction, {wildcards.evaluation}"


if "partition" in STUDY:

    use rule errors as partition with:
        input:
            unpack(lambda wildcards: tables_of(ERROR_TABLES, PAPER.partition(wildcards.ratio))),
        output:
            **figures(PARTITION, caption="partition", section=SECTIONS["numerical"]),
        log:
            PARTITION.log,
        benchmark:
            PARTITION.benchmark
        params:
            **drawing(
                "error_bars",
                lambda wildcards: PARAMS.errors(
                    PAPER.partition(wildcards.ratio),
                    published=STUDY.entry("partition").get("published", {}).get(wildcards.ratio),
                ),
            ),
        message:
            "Figure: errors after training on {wildcards.ratio} % of the dataset"

    use rule errors as partition_curve with:
        input:
            paths_of(rules.evaluate.output.metrics, *PAPER.partitions),
        output:
            **figures(PARTITION_CURVE, section=SECTIONS["numerical"]),
        log:
            PARTITION_CURVE.log,
        benchmark:
            PARTITION_CURVE.benchmark
        params:
            **drawing(
                "partition_curve",
                {
                    "epoch": config["epoch"],
                    "component": PAPER.partitions[0].component,
                    "published": STUDY.entry("partition").get("published", {}),
                },
            ),
        message:
            "Figure: performance metric P_ML against the size of the training data"


if "individual" in STUDY:

    use rule errors as individual with:
        input:
            paths_of(rules.evaluate.output.evaluation, PAPER.individual),
        output:
            **figures(
                product("figs/individual_reduced"),
                product("figs/individual_increased"),
                product("figs/individual_distribution"),
                section=SECTIONS["future"],
            ),
        log:
            INDIVIDUAL.log,
        benchmark:
            INDIVIDUAL.benchmark
        params:
            **drawing(
                "individual",
                {
                    "epoch": config["epoch"],
                    "experiment": PAPER.individual.names(),
                    "published": next(
                        (
                            claim["limit"]
                            for claim in STUDY.entry("evaluations")[STUDY.entry("individual")].get(
                                "claims", []
                            )
                            if claim["holds"] == "share_of_points_near"
                        ),
                        None,
                    ),
                },
            ),
        message:
            "Figures: individual performance metric p_ML"


if "grids" in STUDY:

    use rule errors as rso_grid with:
        input:
            unpack(lambda wildcards: tables_of(ERROR_TABLES, *PAPER.grids[wildcards.grid].values())),
        output:
            **figures(RSO_GRID, caption="rso_grid", section=SECTIONS["future"]),
        log:
            RSO_GRID.log,
        benchmark:
            RSO_GRID.benchmark
        params:
            **drawing(
                "rso_grid",
                lambda wildcards: {
                    "epoch": config["epoch"],
                    "cleaning": dict(STUDY.entry("cleaning")),
                    "experiments": [
                        experiment.names() for experiment in PAPER.grids[wildcards.grid].values()
                    ],
                    "component": next(iter(PAPER.grids[wildcards.grid].values())).component,
                },
            ),
        message:
            "Figure: the correction on other RSOs, {wildcards.grid}"


if "curves" in STUDY:

    use rule errors as transfer_curve with:
        input:
            lambda wildcards: paths_of(
                rules.evaluate.output.metrics, *PAPER.curves[wildcards.curve].experiments
            ),
        output:
            **figures(TRANSFER_CURVE, caption="transfer_curve", section=SECTIONS["nearby"]),
        log:
            TRANSFER_CURVE.log,
        benchmark:
            TRANSFER_CURVE.benchmark
        params:
            **drawing(
                "transfer_curve",
                lambda wildcards: {
                    "epoch": config["epoch"],
                    "curve": wildcards.curve,
                    "targets": PAPER.curves[wildcards.curve].targets,
                    "component": PAPER.curves[wildcards.curve].experiments[0].component,
                    "published": PAPER.curves[wildcards.curve].published,
                },
            ),
        message:
            "Figure: performance metric P_ML on nearby RSOs, {wildcards.curve}"
