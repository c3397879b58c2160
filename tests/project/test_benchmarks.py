"""The benchmarks' arithmetic, tables and figure, on made-up numbers; the peers are not needed."""

import numpy as np
import pytest
from support import refusal

from benchmarks import fits, paper, precision, race, svr, windows
from benchmarks.precision import Line, Point
from opml.catalog.fit.least_squares import Evaluation, Fit, Method


def result(title, cpu, *, vacuum=10.0, drag=1.0):
    about = {"title": title, "method": "Taylor", "raced": "90 s", "way": "in lanes", "model": "forces"}
    return race.Result(
        about, arcs=100, cpu=cpu, wall=cpu, own_error=1.0, vacuum=vacuum, drag=drag, apart=20.0
    )


def test_report_tells_ratios_and_who_did_not_run():
    results = {race.OURS: result("opml", [2.0, 2.0]), "heyoka": result("heyoka", [50.0, 54.0])}
    text = race.report(results, {"orekit": "no data"})
    assert "| heyoka: Taylor, 90 s; in lanes | 100 | 52 | 52 | 26 | 1.0 |" in text
    assert "Not run: orekit (no data)." in text
    assert "disagrees" not in text


@pytest.mark.parametrize("off", [{"vacuum": 600.0}, {"drag": 1.2}])
def test_answers_that_models_do_not_explain_are_told(off):
    results = {race.OURS: result("opml", [2.0]), "heyoka": result("heyoka", [50.0], **off)}
    assert race.disagreements(results) == ["heyoka"]
    assert "**heyoka disagrees" in race.report(results, {})


def fitted(cpu, *, sigmas=0.01):
    about = {"title": "Orekit", "model": "forces", "method": "state and Cd", "way": "steps ≤ 90 s"}
    return fits.Result(
        about, 2, measurements=160.0, iterations=4.0, apart=0.07, sigmas=sigmas, cpu=cpu, wall=cpu
    )


def test_fits_are_told_by_the_median_of_the_rounds():
    results = {(12.0, race.OURS): fitted([20.0, 30.0, 19.0], sigmas=0.0), (12.0, "orekit"): fitted([9000.0])}
    text = fits.report(results, {"brahe": "no tool"})
    assert "| Orekit | 12 h | 160 | 2 | 4 | 20 | 20 | 1.0 | - | - |" in text
    assert "| Orekit | 12 h | 160 | 2 | 4 | 9000 | 9000 | 450 | 0.070 | 0.010 |" in text
    assert "| Orekit: forces | state and Cd; steps ≤ 90 s |" in text
    assert "Not run: brahe (no tool)." in text
    assert "farther apart" not in text


@pytest.mark.parametrize("sigmas", [0.2, np.nan])
def test_fits_that_models_do_not_explain_are_told(sigmas):
    results = {(48.0, race.OURS): fitted([20.0], sigmas=0.0), (48.0, "orekit"): fitted([9.0], sigmas=sigmas)}
    assert fits.disagreements(results) == ["orekit, 48 h"]
    assert "**orekit, 48 h: the answers are farther apart" in fits.report(results, {})


def test_answers_that_did_not_converge_are_not_finite():
    method = Method(np.ones(7), np.ones(7, bool), convergence=1e-3)
    done, failed = Fit(np.zeros(7), method), Fit(np.zeros(7), method)
    while done.running:
        done.take(Evaluation(np.arange(7.0) - done.trial, np.eye(7)))
    failed.reject("start arc lost")
    states = windows.answers([done, failed]).states
    np.testing.assert_allclose(states[0], np.arange(6.0), atol=1e-2)
    assert np.all(np.isnan(states[1]))


def line(name, points, *, unsettled=0.001):
    about = {"title": name, "method": "Taylor", "tight": ["1e-14", "1e-15"]}
    return Line(about, 8, [Point(*point) for point in points], unsettled)


def panels(*points, **options):
    ours = line("opml", [("180 s", 1.0, 1.0), ("90 s", 2.0, 0.02)])
    return {
        "without radiation pressure": {race.OURS: ours, "heyoka": line("heyoka", points, **options)},
        "with radiation pressure": {race.OURS: ours},
    }


def test_a_peer_stands_beside_the_cheapest_of_ours_that_is_as_precise():
    found = panels(("1e-8", 30.0, 5.0), ("1e-9", 40.0, 0.5))
    text = precision.report(found, {"orekit": "no data"})
    assert "| heyoka, Taylor | 1e-8 | 8 | 30 | 5.0 | 30 | 180 s |" in text
    assert "| heyoka, Taylor | 1e-9 | 8 | 40 | 0.50 | 20 | 90 s |" in text
    assert "takes 20 to 30 times less" in text
    assert "| heyoka, Taylor | 1e-14 and 1e-15 | 0.0010 | - |" in text
    assert "Not run: orekit (no data)." in text


def test_a_peer_that_is_faster_or_more_precise_is_told():
    text = precision.report(panels(("1e-8", 0.9, 5.0), ("1e-12", 90.0, 0.001)), {})
    told = "heyoka, Taylor, {}, without radiation pressure ({})"
    faster, finer = (
        told.format("1e-8", "0.90 times opml"),
        told.format("1e-12", "more precise than any of opml's"),
    )
    assert f"**opml is not ahead of** {faster}; {finer}." in text


def leave(folder, name, text="s\th:m:s\tcpu_time\n{0}\t0:00:01\t{1}\n", *, wall=2.0, processor=1.0):
    path = folder / "benchmarks" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text.format(wall, processor))


def test_a_folder_without_benchmarks_is_told(tmp_path, capsys):
    assert paper.main([str(tmp_path)]) == 2
    assert "expected the benchmarks of a finished run, got none" in capsys.readouterr().err
    leave(tmp_path, "truth/iss.tsv", "nothing\n1\n")
    assert "iss.tsv: expected a benchmark with cpu_time and s" in refusal(paper.costs, tmp_path)


def test_the_solver_stands_beside_libsvm():
    settings = {"kernel_scale": "sigest", "c": 1.0, "epsilon": 0.1, "tol": 1e-5}
    text = svr.compare(svr._made_up(rows=200, count=4), settings)
    lines = {line.split(" | ")[0]: line.split(" | ")[5:] for line in text.splitlines() if " | " in line}
    assert lines["| opml"] == lines["| scikit-learn (libsvm)"]  # support vectors and P_ML
