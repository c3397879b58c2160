# Beyond the paper: models against splits without leaks, other RSOs, intervals, and an error budget.
if "beyond" in STUDY:
    STATION_SETS = BEYOND.entry["station_sets"]

    use rule errors as beyond_report with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *BEYOND.every),
            coverage=paths_of(rules.intervals.output.coverage, *BEYOND.intervals.values()),
            datasets=[
                path_of(
                    rules.dataset.output[0],
                    rso=STUDY.defaults["rso"],
                    stations=stations,
                    window="",
                    reading="",
                )
                for stations in STATION_SETS
            ],
            oracles=[
                path_of(rules.oracle.output[0], rso=STUDY.defaults["rso"], stations=stations)
                for stations in STATION_SETS
            ],
        output:
            **documents("beyond", section=SECTIONS["beyond"]),
        log:
            f"{RESULTS}/logs/beyond.log",
        benchmark:
            f"{RESULTS}/benchmarks/beyond.tsv"
        resources:
            mem_mb=1500,
            runtime=5,
        params:
            draw="beyond_report",
            settings=config,
            code=code("beyond_report.py"),
        message:
            "Beyond the paper: models against splits, with baselines and intervals"

    use rule errors as beyond_splits with:
        input:
            paths_of(rules.evaluate.output.metrics, *BEYOND.splits.values()),
        output:
            **figures("beyond", section=SECTIONS["beyond"]),
        log:
            f"{RESULTS}/logs/figs/beyond.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/beyond.tsv"
        params:
            **drawing(
                "beyond_splits",
                component=STUDY.defaults["component"],
                published=[[*key, number] for key, number in BEYOND.published_p_ml(BEYOND.splits).items()],
                models={
                    name: naming.parse_learner(name, config["learners"]) for name in BEYOND.entry["learners"]
                },
                **{key: BEYOND.entry[key] for key in ("station_sets", "learners", "splits")},
            ),
        message:
            "Figure: performance metric P_ML of models against splits"

    use rule errors as beyond_transfers with:
        input:
            paths_of(rules.evaluate.output.metrics, *BEYOND.transfers.values()),
        output:
            **figures("beyond_transfers", section=SECTIONS["beyond"]),
        log:
            f"{RESULTS}/logs/figs/beyond_transfers.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/beyond_transfers.tsv"
        params:
            **drawing(
                "beyond_transfers",
                component=STUDY.defaults["component"],
                published=[
                    [*key, number] for key, number in BEYOND.published_p_ml(BEYOND.transfers).items()
                ],
                curves={name: curve.targets for name, curve in PAPER.curves.items()},
            ),
        message:
            "Figure: performance metric P_ML of models on nearby RSOs"

    use rule errors as beyond_intervals with:
        input:
            paths_of(rules.intervals.output.intervals, *BEYOND.shown_intervals.values()),
        output:
            **figures("beyond_intervals", section=SECTIONS["beyond"]),
        log:
            f"{RESULTS}/logs/figs/beyond_intervals.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/beyond_intervals.tsv"
        params:
            **drawing(
                "beyond_intervals",
                level=config["intervals"]["level"],
                learners=list(BEYOND.shown_intervals),
                **(next(iter(BEYOND.shown_intervals.values())).names() | {"learner": "models"}),
            ),
        message:
            "Figure: prediction intervals"
