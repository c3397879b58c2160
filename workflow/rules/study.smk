# A study of any RSO: errors before and after correction, models against splits, rows used.
STUDY_REPORT = product("study")
STUDY_MODELS = product("figs/study/{rso}/models")

if OWN.is_asked:

    use rule errors as study_report with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *OWN.experiments.values()),
            evaluations=paths_of(rules.evaluate.output.evaluation, *OWN.stated.values()),
            datasets=[labelled(rso, stations) for rso, stations in OWN.datasets],
            estimates=[
                path_of(rules.estimation.output[0], rso=rso, stations=stations, window="")
                for rso, stations in OWN.datasets
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
            "Study: errors with and without learning, by model and split"

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
                "study_models",
                {
                    "epoch": config["epoch"],
                    "component": STUDY.defaults["component"],
                    "station_sets": OWN.panels,
                    "learners": OWN.learners,
                    "splits": OWN.splits,
                    "models": {name: one.of_job() for name, one in OWN.report.learners.items()},
                    "weather": PLAN.weather,
                },
            ),
        message:
            "Figure: performance metric P_ML of models against splits, {wildcards.rso}"
