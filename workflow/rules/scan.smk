# Combinations of readings of what the paper leaves open, held against its numbers and sentences.
from opml.readings.scan import scan as scanned

if "scan" in STUDY:
    SCAN = scanned(PAPER)

    use rule errors as scan_report with:
        input:
            paths_of(rules.evaluate.output.metrics, *SCAN.experiments),
        output:
            **documents("scan", section=SECTIONS["beyond"]),
        log:
            f"{RESULTS}/logs/scan.log",
        benchmark:
            f"{RESULTS}/benchmarks/scan.tsv"
        params:
            draw="scan",
            settings=config,
            code=code("scan.py"),
        message:
            "Scan: combinations of readings against the paper's numbers and sentences"

    use rule errors as scan_curves with:
        input:
            rules.scan_report.input,
        output:
            **figures("scan", section=SECTIONS["beyond"]),
        log:
            f"{RESULTS}/logs/figs/scan.log",
        benchmark:
            f"{RESULTS}/benchmarks/figs/scan.tsv"
        params:
            draw="scan_curves",
            settings=config,
            code=code("scan_curves.py"),
        message:
            "Figure: the paper's numbers and combinations of readings"
