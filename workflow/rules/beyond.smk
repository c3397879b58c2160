# Beyond the paper: models against splits without leaks, and other RSOs.
BEYOND_REPORT = product("beyond")
BEYOND_SPLITS = product("figs/beyond")

if "beyond" in STUDY:

    use rule errors as beyond_report with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *BEYOND.every),
        output:
            **documents(BEYOND_REPORT, section=SECTIONS["beyond"]),
        log:
            BEYOND_REPORT.log,
        benchmark:
            BEYOND_REPORT.benchmark
        resources:
            mem_mb=1500,
            runtime=5,
        params:
            **drawing("beyond_report", config),
        message:
            "Beyond the paper: models against splits, with baselines"

    use rule errors as beyond_splits with:
        input:
            paths_of(rules.evaluate.output.metrics, *BEYOND.splits.values()),
        output:
            **figures(BEYOND_SPLITS, section=SECTIONS["beyond"]),
        log:
            BEYOND_SPLITS.log,
        benchmark:
            BEYOND_SPLITS.benchmark
        params:
            **drawing(
                "beyond_splits",
                {
                    "epoch": config["epoch"],
                    "component": STUDY.defaults["component"],
                    "published": [
                        [*key, number] for key, number in BEYOND.published_p_ml(BEYOND.splits).items()
                    ],
                    "models": {
                        name: naming.parse_learner(name, STUDY.learners).of_job()
                        for name in BEYOND.entry["learners"]
                    },
                    **{key: BEYOND.entry[key] for key in ("station_sets", "learners", "splits")},
                },
            ),
        message:
            "Figure: performance metric P_ML of models against splits"
