# Beyond the paper: models against splits without leaks, other RSOs, intervals, and an error budget.
if "generalisation" in STUDY:
    BEYOND = SECTIONS["beyond"]
    STATION_SETS = HONEST.entry["station_sets"]

    use rule errors as generalisation with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *HONEST.every),
            coverage=paths_of(rules.intervals.output.coverage, *HONEST.intervals.values()),
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
            **documents("generalisation", section=BEYOND),
        log:
            f"{RESULTS}/logs/generalisation.log",
        benchmark:
            f"{RESULTS}/benchmarks/generalisation.tsv"
        resources:
            mem_mb=1500,
            runtime=5,
        params:
            draw="generalisation",
            settings=config,
            code=code("generalisation.py"),
        message:
            "Generalisation: models against splits, with baselines and intervals"

    use rule errors as generalisation_splits with:
        input:
            paths_of(rules.evaluate.output.metrics, *HONEST.splits.values()),
        output:
            **figures("generalisation", section=BEYOND),
        log:
            f"{RESULTS}/logs/figs/generalisation.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/generalisation.tsv"
        params:
            **drawing(
                "generalisation_splits",
                component=STUDY.defaults["component"],
                published=[[*key, number] for key, number in HONEST.published(HONEST.splits).items()],
                models={
                    name: naming.parse_learner(name, config["learners"]) for name in HONEST.entry["learners"]
                },
                **{key: HONEST.entry[key] for key in ("station_sets", "learners", "splits")},
            ),
        message:
            "Figure: performance metric P_ML of models against splits"

    use rule errors as generalisation_transfers with:
        input:
            paths_of(rules.evaluate.output.metrics, *HONEST.transfers.values()),
        output:
            **figures("generalisation_transfers", section=BEYOND),
        log:
            f"{RESULTS}/logs/figs/generalisation_transfers.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/generalisation_transfers.tsv"
        params:
            **drawing(
                "generalisation_transfers",
                component=STUDY.defaults["component"],
                published=[[*key, number] for key, number in HONEST.published(HONEST.transfers).items()],
                curves={name: curve.targets for name, curve in PAPER.curves.items()},
            ),
        message:
            "Figure: performance metric P_ML of models on nearby RSOs"

    use rule errors as generalisation_intervals with:
        input:
            paths_of(rules.intervals.output.intervals, *HONEST.shown_intervals.values()),
        output:
            **figures("generalisation_intervals", section=BEYOND),
        log:
            f"{RESULTS}/logs/figs/generalisation_intervals.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/generalisation_intervals.tsv"
        params:
            **drawing(
                "generalisation_intervals",
                level=config["intervals"]["level"],
                learners=list(HONEST.shown_intervals),
                **(next(iter(HONEST.shown_intervals.values())).names() | {"learner": "models"}),
            ),
        message:
            "Figure: prediction intervals"
