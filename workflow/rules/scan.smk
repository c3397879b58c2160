# Combinations of readings, where the paper leaves a choice, compared with its numbers and sentences.
from opml.readings.scan import scan as scanned

SCAN_REPORT = product("scan")
SCAN_CURVES = product("figs/scan")

if "scan" in STUDY:
    SCAN = scanned(PAPER)

    use rule errors as scan_report with:
        input:
            paths_of(rules.evaluate.output.metrics, *SCAN.experiments),
        output:
            **documents(SCAN_REPORT, section=SECTIONS["beyond"]),
        log:
            SCAN_REPORT.log,
        benchmark:
            SCAN_REPORT.benchmark
        params:
            **drawing("scan", config),
        message:
            "Scan: combinations of readings against the paper's numbers and sentences"

    use rule errors as scan_dots with:
        input:
            rules.scan_report.input,
        output:
            **figures(SCAN_CURVES, section=SECTIONS["beyond"]),
        log:
            SCAN_CURVES.log,
        benchmark:
            SCAN_CURVES.benchmark
        params:
            **drawing("scan_dots", config),
        message:
            "Figure: the paper's numbers and combinations of readings"
