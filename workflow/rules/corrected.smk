# What leaves the house: ephemerides corrected by what was learned, each epoch with a covariance. None needs a truth.
EPHEMERIS = "{rso}/{stations}{window}{reading}{label}/{train}/{learner}"


def without_truth(wildcards):
    """Raises InputError for a learner that knows what only a simulation does."""
    learners.check_without_truth(wildcards.learner, learner(wildcards))


def fits_over(kind):
    """Input function: the estimates over another window, where the learner asks for a kind of table of them."""

    def find(wildcards):
        settings = learner(wildcards)
        if kind not in learners.tables_asked(settings["variables"]):
            return []
        hours = arc_hours(settings)[0] if kind == "arcs" else config["mechanism"]["long_window_hours"]
        window = naming.windowed(hours, default=config["estimation"]["window_hours"])
        return path_of(
            rules.estimation.output[0], rso=wildcards.rso, stations=wildcards.stations, window=window
        )

    return find


def arc_hours(settings):
    """Window [h] and memory [days] of the arcs that resolved settings of a learner ask for, or none of both."""
    return learners.arc_of(settings) or (0.0, 0.0)


def told_manoeuvres(wildcards):
    """The table whose metadata tell manoeuvres: of an orbit or tracks of one's own; none of a simulated RSO."""
    base, *_ = naming.rso_parts(wildcards.rso, SETTINGS.rsos)
    return known_manoeuvres(wildcards) if base in {*SETTINGS.orbits, *SETTINGS.tracks} else []


def known_until_days(wildcards):
    """Day at which a training ends: the last of its window, or of the span that a share is drawn from."""
    days = naming.parse_train(split(wildcards)["train"]).days
    return days[1] or STUDY.span_days[1]


rule residuals:
    input:
        dataset=rules.train.input.dataset,
        beside=beside("rso"),
        asked=checked_names(split, without_truth),
    output:
        f"{RESULTS}/residuals/{EPHEMERIS}.parquet",
    log:
        f"{RESULTS}/logs/residuals/{EPHEMERIS}.log",
    benchmark:
        f"{RESULTS}/benchmarks/residuals/{EPHEMERIS}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=16,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "span_days": STUDY.span_days,
            "learner": learner(wildcards),
            "intervals": config["intervals"],
        },
        code=code("residuals.py"),
    message:
        "Residuals: what {wildcards.learner} leaves of the errors of {wildcards.rso} by {wildcards.stations}, held out"
    script:
        "../scripts/residuals.py"


rule corrected:
    input:
        **ENVIRONMENT,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        long_estimates=fits_over("mechanism"),
        arc_estimates=fits_over("arcs"),
        manoeuvres=told_manoeuvres,
        model=f"{RESULTS}/models/{EPHEMERIS}/{residuals.CORRECTED}.parquet",
        residuals=rules.residuals.output[0],
        asked=checked_names(split, without_truth),
    output:
        f"{RESULTS}/corrected/{EPHEMERIS}.parquet",
    log:
        f"{RESULTS}/logs/corrected/{EPHEMERIS}.log",
    benchmark:
        f"{RESULTS}/benchmarks/corrected/{EPHEMERIS}.tsv"
    wildcard_constraints:
        window=WINDOW,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "rso": rso(wildcards),
            "cleaning": cleaning(wildcards),
            "window_hours": window_hours(wildcards),
            "cd_bounds": cd_bounds(),
            "mechanism": config["mechanism"],
            "arc": arc_hours(learner(wildcards)),
            "known_until_days": known_until_days(wildcards),
            "from": config["ephemeris"]["from"],
            "grid": [
                config["ephemeris"]["step_s"],
                config["prediction"]["max_days"],
                config["duration_days"],
            ],
        },
        code=code("corrected.py"),
    message:
        "Corrected ephemeris: {wildcards.rso} by {wildcards.stations}, corrected by {wildcards.learner}"
    script:
        "../scripts/corrected.py"


use rule export_truth as export_corrected with:
    input:
        rules.corrected.output[0],
    output:
        f"{RESULTS}/corrected/{EPHEMERIS}.oem",
    log:
        f"{RESULTS}/logs/corrected/{EPHEMERIS}_oem.log",
    benchmark:
        f"{RESULTS}/benchmarks/corrected/{EPHEMERIS}_oem.tsv"
    wildcard_constraints:
        window=WINDOW,
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "corrected", "rso": wildcards.rso},
        code=code("export_oem.py"),
    message:
        "Export: corrected ephemeris of {wildcards.rso} by {wildcards.stations}, with covariances, as CCSDS OEM"


use rule errors as corrected_figure with:
    input:
        corrected=rules.corrected.output[0],
        estimates=rules.estimation.output[0],
    output:
        pdf=f"{RESULTS}/figs/corrected/{EPHEMERIS}.pdf",
        png=f"{RESULTS}/figs/corrected/{EPHEMERIS}.png",
    log:
        f"{RESULTS}/logs/figs/corrected/{EPHEMERIS}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/corrected/{EPHEMERIS}.tsv"
    wildcard_constraints:
        window=WINDOW,
    params:
        **drawing("corrected_figure", level=config["intervals"]["level"]),
    message:
        "Figure: {wildcards.rso} by {wildcards.stations} as predicted, as corrected, and as measured later"
