# A study of any RSO: its report, errors before and after correction, models against splits, rows used.
from snakemake.logging import logger

from opml.workflow import extras

if OWN.is_asked:

    use rule errors as study_report with:
        input:
            metrics=paths_of(rules.evaluate.output.metrics, *OWN.experiments.values()),
            evaluations=paths_of(rules.evaluate.output.evaluation, *OWN.stated.values()),
            datasets=[
                path_of(
                    rules.labelled_dataset.output[0],
                    **{"rso": rso, "stations": stations, "window": "", "reading": ""},
                    label=naming.LABELS[STUDY.label],
                )
                for rso, stations in OWN.datasets
            ],
            estimates=[
                path_of(rules.estimation.output[0], rso=rso, stations=stations, window="")
                for rso, stations in OWN.datasets
            ],
            rolling=paths_of(rules.rolling.output[0], *OWN.rolling.values()),
            replays=[path_of(rules.replay.output[0], **parts) for parts in OWN.replayed.values()],
            fits=paths_of(rules.fit_calibration.output[0], *OWN.fits.values()),
        output:
            **documents("study", section=SECTIONS["study"]),
        log:
            f"{RESULTS}/logs/study.log",
        benchmark:
            f"{RESULTS}/benchmarks/study.tsv"
        params:
            draw="study",
            settings=config,
            code=code("study.py"),
        message:
            "Study: models against splits, errors before and after, rows used"

    use rule errors as study_errors with:
        input:
            lambda wildcards: paths_of(
                rules.evaluate.output.evaluation,
                *OWN.corrections(wildcards.rso, wildcards.stations).values(),
            ),
        output:
            **figures("study/{rso}/{stations}_errors", caption="study_errors", section=SECTIONS["study"]),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/{{stations}}_errors.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/{{stations}}_errors.tsv"
        params:
            draw="study_errors",
            settings=lambda wildcards: all_of(OWN.corrections(wildcards.rso, wildcards.stations), "learners"),
            code=code("study_errors.py"),
        message:
            "Figure: errors of {wildcards.rso} by {wildcards.stations} before and after correction"

    use rule errors as study_residuals with:
        input:
            lambda wildcards: [
                path_of(rules.replay.output[0], **parts)
                for parts in OWN.mornings(wildcards.rso, wildcards.stations).values()
            ],
        output:
            **figures(
                "study/{rso}/{stations}_residuals", caption="study_residuals", section=SECTIONS["study"]
            ),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/{{stations}}_residuals.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/{{stations}}_residuals.tsv"
        params:
            draw="study_residuals",
            settings=mornings_settings,
            code=code("study_residuals.py"),
        message:
            "Figure: errors of {wildcards.rso} by {wildcards.stations}, and what each model leaves of them"

    use rule errors as explore with:
        input:
            evaluations=rules.study_errors.input[0],
            dataset=lambda wildcards: path_of(
                rules.dataset.output[0], **dict(wildcards.items()) | {"window": "", "reading": ""}
            ),
            truth=rules.truth.output[0],
            earth_orientation=ENVIRONMENT["earth_orientation"],
        output:
            shown_in_report("figs/study/{rso}/{stations}_explore", ".html", SECTIONS["study"], "explore"),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/{{stations}}_explore.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/{{stations}}_explore.tsv"
        params:
            draw="explore",
            settings=lambda wildcards: {
                **all_of(OWN.corrections(wildcards.rso, wildcards.stations), "learners"),
                "radars": stations(wildcards),
            },
            code=code("explore.py"),
        message:
            "Page: turn the orbit of {wildcards.rso}, pick an estimate of {wildcards.stations}"

    if workflow.is_main_process and not extras.can_explore():
        logger.warning(extras.NO_EXPLORE)

    use rule errors as study_calibration with:
        input:
            fit=lambda wildcards: path_of(
                rules.fit_calibration.output[0], **OWN.fits[wildcards.rso, wildcards.stations].names()
            ),
            replays=rules.study_residuals.input[0],
        output:
            **figures(
                "study/{rso}/{stations}_intervals",
                "study/{rso}/{stations}_ellipsoids",
                caption="study_calibration",
                section=SECTIONS["study"],
            ),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/{{stations}}_calibration.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/{{stations}}_calibration.tsv"
        params:
            draw="study_calibration",
            settings=mornings_settings,
            code=code("study_calibration.py"),
        message:
            "Figure: nominal and achieved coverage of {wildcards.rso} by {wildcards.stations}"

    use rule errors as study_drag with:
        input:
            estimates=lambda wildcards: [
                path_of(rules.estimation.output[0], **dict(wildcards.items()), window=window)
                for window in OWN.windows.values()
            ],
            activity=lambda wildcards: (
                ENVIRONMENT if wildcards.rso in SETTINGS.tracks else TRUE_ENVIRONMENT
            )["solar_activity"],
            dataset=lambda wildcards: path_of(
                rules.labelled_dataset.output[0],
                **dict(wildcards.items()) | {"window": "", "reading": ""},
                label=naming.LABELS[STUDY.label],
            ),
        output:
            **figures("study/{rso}/{stations}_drag", caption="study_drag", section=SECTIONS["study"]),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/{{stations}}_drag.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/{{stations}}_drag.tsv"
        params:
            draw="study_drag",
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "windows": list(OWN.windows),
                "component": STUDY.defaults["component"],
                "marks": OWN.marks,
                "weather": WEATHER,
                **dict(wildcards.items()),
            },
            code=code("study_drag.py"),
        message:
            "Figure: drag coefficients of {wildcards.rso} by {wildcards.stations} beside the solar activity"

    use rule errors as study_models with:
        input:
            lambda wildcards: paths_of(
                rules.evaluate.output.metrics,
                *(one for (rso, *_), one in OWN.experiments.items() if rso == wildcards.rso),
            ),
        output:
            **figures("study/{rso}/models", caption="study_models", section=SECTIONS["study"]),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/models.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/models.tsv"
        params:
            **drawing(
                "beyond_splits",
                component=STUDY.defaults["component"],
                published=[],
                station_sets=OWN.panels,
                learners=OWN.learners,
                splits=OWN.splits,
                models=OWN.report.learners,
                weather=WEATHER,
            ),
        message:
            "Figure: performance metric P_ML of models against splits, {wildcards.rso}"

    use rule errors as study_rolling with:
        input:
            lambda wildcards: paths_of(
                rules.rolling.output[0],
                *(
                    one
                    for (rso, stations, _), one in OWN.rolling.items()
                    if (rso, stations) == (wildcards.rso, wildcards.stations)
                ),
            ),
        output:
            **figures("study/{rso}/{stations}_rolling", caption="study_rolling", section=SECTIONS["study"]),
        log:
            f"{RESULTS}/logs/figs/study/{{rso}}/{{stations}}_rolling.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/{{rso}}/{{stations}}_rolling.tsv"
        params:
            draw="study_rolling",
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "learners": list(STUDY.entry("rolling").get("learners", [])),
                "weather": WEATHER,
                **STUDY.rolling,
                **dict(wildcards.items()),
            },
            code=code("study_rolling.py"),
        message:
            "Figure: P_ML of {wildcards.rso} by {wildcards.stations} day by day, learners trained anew and once"

    use rule errors as study_rows with:
        input:
            rules.study_report.input.datasets,
        output:
            **figures("study/rows", caption="study_rows", section=SECTIONS["study"]),
        log:
            f"{RESULTS}/logs/figs/study/rows.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/study/rows.tsv"
        params:
            **drawing("study_rows", datasets=[f"{rso}, {stations}" for rso, stations in OWN.datasets]),
        message:
            "Figure: rows used, and why others are not"
