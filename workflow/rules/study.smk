# A study of any RSO: its report, errors before and after correction, models against splits, rows used.
from snakemake.logging import logger

STUDY_REPORT = product("study")
STUDY_RESIDUALS = product("figs/study/{rso}/{stations}_residuals")
STUDY_DRAG = product("figs/study/{rso}/{stations}_drag")
STUDY_MODELS = product("figs/study/{rso}/models")

if OWN.is_asked:

    use rule errors as study_residuals with:
        input:
            replays=lambda wildcards: [
                path_of(rules.replay.output[0], **parts)
                for parts in OWN.mornings(wildcards.rso, wildcards.stations).values()
            ],
            judge=lambda wildcards: (
                [
                    true_errors(wildcards.rso, wildcards.stations),
                    labelled(wildcards.rso, wildcards.stations),
                ]
                if (wildcards.rso, wildcards.stations) in OWN.datasets_with_truth
                else []
            ),
        output:
            **figures(STUDY_RESIDUALS, caption="study_residuals", section=SECTIONS["study"]),
        log:
            STUDY_RESIDUALS.log,
        benchmark:
            STUDY_RESIDUALS.benchmark
        params:
            **drawing("study_residuals", PARAMS.mornings),
        message:
            "Figure: errors of {wildcards.rso} by {wildcards.stations}, with each model"

    use rule errors as study_report with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *OWN.experiments.values()),
            evaluations=paths_of(rules.evaluate.output.evaluation, *OWN.stated.values()),
            datasets=[labelled(rso, stations) for rso, stations in OWN.datasets],
            truths=[true_errors(rso, stations) for rso, stations in OWN.datasets_with_truth],
            estimates=[
                path_of(rules.estimation.output[0], rso=rso, stations=stations, window="")
                for rso, stations in OWN.datasets
            ],
            replays=[path_of(rules.replay.output[0], **parts) for parts in OWN.replayed.values()],
            pictures=[
                path_of(rules.study_residuals.output.png[0], rso=rso, stations=stations)
                for rso, stations in OWN.replayed_datasets
            ],
        output:
            **documents(STUDY_REPORT, section=SECTIONS["study"]),
        log:
            STUDY_REPORT.log,
        benchmark:
            STUDY_REPORT.benchmark
        params:
            **drawing("study", config),
        message:
            "Study: which model to use, and why"

    use rule errors as study_drag with:
        input:
            estimates=lambda wildcards: [
                path_of(rules.estimation.output[0], **dict(wildcards.items()), window=window)
                for window in OWN.windows.values()
            ],
            activity=INPUTS.activity,
            dataset=lambda wildcards: labelled(wildcards.rso, wildcards.stations),
            manoeuvres=INPUTS.user_manoeuvres(rules.truth.output[0], rules.tracking.output[0]),
        output:
            **figures(STUDY_DRAG, caption="study_drag", section=SECTIONS["study"]),
        log:
            STUDY_DRAG.log,
        benchmark:
            STUDY_DRAG.benchmark
        params:
            **drawing(
                "study_drag",
                lambda wildcards: {
                    "epoch": config["epoch"],
                    "windows": list(OWN.windows),
                    "component": STUDY.defaults["component"],
                    "marks": OWN.marks,
                    "weather": PLAN.weather,
                    **dict(wildcards.items()),
                },
            ),
        message:
            "Figure: drag coefficients of {wildcards.rso} by {wildcards.stations}, and the solar activity"

    use rule errors as study_models with:
        input:
            lambda wildcards: paths_of(
                rules.evaluate.output.metrics,
                *(experiment for (rso, *_), experiment in OWN.experiments.items() if rso == wildcards.rso),
            ),
        output:
            **figures(STUDY_MODELS, caption="study_models", section=SECTIONS["study"]),
        log:
            STUDY_MODELS.log,
        benchmark:
            STUDY_MODELS.benchmark
        params:
            **drawing(
                "beyond_splits",
                {
                    "epoch": config["epoch"],
                    "component": STUDY.defaults["component"],
                    "published": [],
                    "station_sets": OWN.panels,
                    "learners": OWN.learners,
                    "splits": OWN.splits,
                    "models": {name: one.of_job() for name, one in OWN.report.learners.items()},
                    "weather": PLAN.weather,
                },
            ),
        message:
            "Figure: performance metric P_ML of models against splits, {wildcards.rso}"
