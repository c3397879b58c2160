"""The benchmarks' arithmetic, tables and figure, on made-up numbers; the peers are not needed."""

import numpy as np
import pandas as pd
import pytest
from support import force_model, refusal

from benchmarks import (
    case,
    diagram,
    fits,
    kernels,
    measure,
    paper,
    precision,
    race,
    sections,
    svr,
    turns,
    windows,
)
from benchmarks.fitters import FITTERS
from benchmarks.kernels import Machine, Work
from benchmarks.peers import FLYERS
from benchmarks.precision import Line, Point
from benchmarks.windows import Windows
from benchmarks.worker import Timed
from opml.catalog.fit.least_squares import Evaluation, Fit, Method
from opml.orbits.elements import cartesian_from_coe

GM = 3.986004418e14


def result(title, cpu, *, vacuum=10.0, drag=1.0):
    about = {"title": title, "method": "Taylor", "raced": "90 s", "way": "in lanes", "model": "forces"}
    return race.Result(
        about, arcs=100, cpu=cpu, wall=cpu, own_error=1.0, vacuum=vacuum, drag=drag, apart=20.0
    )


def test_cost_is_spread_over_arcs_and_days():
    assert measure.per_arc_day(7.0, 100 * 7) == 10.0


@pytest.mark.slow
def test_gravity_is_timed_with_what_it_takes():
    state = np.zeros((9, 16))
    state[:3] = 7e6
    kernels._gravity(1, state, force_model(4))
    assert np.isfinite(state[8]).all()
    assert state[8, 0] != 0.0


def test_ratio_pairs_the_rounds():
    assert measure.paired_ratio([2.0, 40.0, 6.0], [1.0, 10.0, 2.0]) == 3.0


def test_along_track_is_the_angle_ahead():
    a, b = (cartesian_from_coe(np.array([[7e6, 0.0, 1.0, 0.0, 0.5, nu]]), GM) for nu in (0.3, 0.301))
    assert measure.along_track(b, a) == pytest.approx([0.001])
    assert measure.distances(b, a) == pytest.approx([7000.0], rel=1e-6)


def test_least_time_counts_each_unit_for_a_whole_register():
    machine = Machine(fused=0.1, division=4.0, root=5.0)
    assert machine.least(Work(operations=160, instructions=80, divisions=2, roots=1)) == pytest.approx(21 / 8)
    assert machine.peak == pytest.approx(160.0)


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


class Fake:
    """A worker whose flights take the seconds given, and end at ones."""

    def __init__(self, *seconds):
        self.seconds = list(seconds)

    def call(self, method, arcs, setting):
        seconds = self.seconds.pop(0)
        return Timed(np.ones((len(arcs), 6)), wall=seconds, cpu=seconds)


def arcs(count, *, t=0.0, days=1.0):
    return case.Arcs(np.full(count, t), np.zeros((count, 6)), days * 86400.0, 0.01, 0.01)


def test_tools_fly_in_turns_and_slow_ones_once():
    propagations = {
        "quick": turns.Propagation(Fake(1.0, 2.0, 3.0), arcs(10), "90 s"),
        "slow": turns.Propagation(Fake(50.0), arcs(1), "90 s"),
    }
    flown = turns.fly(propagations, rounds=3, progress=str, longest=10.0)
    assert flown["quick"].cpu == flown["quick"].wall == [100.0, 200.0, 300.0]
    assert flown["slow"].cpu == [50_000.0]
    assert flown["slow"].states.shape == (1, 6)


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


def test_every_fitter_has_a_bound():
    assert set(fits.BOUNDS) == set(FITTERS)


def test_a_window_holds_the_tracks_that_begin_in_it():
    begins, track = np.array([0.0, 50.0, 3600.0, 3700.0]), np.arange(4)
    measured = pd.DataFrame({"track": track.repeat(2), "t": np.ravel([begins, begins + 20.0], order="F")})
    drawn = Windows(measured, track[:2], begins[:2], np.zeros((2, 6)), hours=1.0)
    assert drawn.rows(0)["track"].tolist() == [0, 0, 1, 1, 2, 2]
    assert drawn.rows(1)["track"].tolist() == [1, 1, 2, 2]


@pytest.mark.parametrize(("count", "tracks"), [(1, [2]), (2, [1, 3]), (4, [0, 1, 2, 3])])
def test_a_sample_of_windows_is_from_the_middle(count, tracks):
    drawn = Windows(pd.DataFrame(), np.arange(4), np.arange(4.0), np.zeros((4, 6)), hours=12.0)
    assert drawn.sample(count).tracks.tolist() == tracks


def test_answers_that_did_not_converge_are_not_finite():
    method = Method(np.ones(7), np.ones(7, bool), convergence=1e-3)
    done, failed = Fit(np.zeros(7), method), Fit(np.zeros(7), method)
    while done.running:
        done.take(Evaluation(np.arange(7.0) - done.trial, np.eye(7)))
    failed.reject("start arc lost")
    states = windows.answers([done, failed]).states
    np.testing.assert_allclose(states[0], np.arange(6.0), atol=1e-2)
    assert np.all(np.isnan(states[1]))


def test_a_difference_is_measured_in_formal_sigmas():
    assert measure.sigmas(np.array([3.0, 8.0]), np.diag([1.0, 4.0])) == pytest.approx(5.0)


def test_arcs_stop_about_midnights_and_at_their_end():
    first = 11 * 3600 + 50 * 60 + 15.0  # the paper's epoch is 12:09:45
    second, end = first + 86400.0, 100.0 + 2 * 86400.0
    expected = [first - 0.01, first, second - 0.01, second, end]
    np.testing.assert_allclose(arcs(1, t=100.0, days=2.0).stops(100.0), expected, rtol=0.0, atol=1e-6)


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


def test_below_a_centimetre_all_are_equally_precise():
    ours = line("opml", [("120 s", 2.0, 0.009), ("90 s", 3.0, 0.001)])
    assert ours.cheapest(0.005).setting == "120 s"
    assert line("opml", [("120 s", 2.0, 0.02)]).cheapest(0.005) is None


def test_truths_that_are_not_settled_are_told():
    assert "| **0.30** | - |" in precision.report(panels(("1e-8", 9.0, 5.0), unsettled=0.3), {})


def test_the_diagram_has_a_line_for_every_tool(tmp_path):
    figure = diagram.work_precision(panels(("1e-8", 30.0, 5.0), ("1e-9", 40.0, 0.5)))
    drawn = [[tuple(one.get_xdata()) for one in axes.get_lines()] for axes in figure.axes]
    assert drawn == [[(1.0, 0.02), (5.0, 0.5)], [(1.0, 0.02)]]
    diagram.save(figure, tmp_path / "a.png")
    diagram.save(figure, tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_every_peer_has_a_look():
    assert set(diagram.LOOKS) == set(FLYERS)


def test_a_section_is_replaced_in_place():
    page = "# Old\n\nold\n\n## Beside the peers\n\na\n\n## Kernels\n\nb\n"
    made = {"Work and precision": "new\n", "Kernels": "c"}
    expected = "# New\n\n## Beside the peers\n\na\n\n## Work and precision\n\nnew\n\n## Kernels\n\nc\n"
    assert sections.replaced(page, "# New\n", made) == expected
    assert sections.replaced("", "# New\n", {"Arcs": "d"}) == "# New\n\n## Arcs\n\nd\n"


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0"), (1.66, "1.7"), (1234.5, "1234"), (0.0123, "0.012"), (np.nan, "nan")]
)
def test_figures_are_plain(value, text):
    assert measure.figures(value) == text


def leave(folder, name, text="s\th:m:s\tcpu_time\n{0}\t0:00:01\t{1}\n", *, wall=2.0, processor=1.0):
    path = folder / "benchmarks" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text.format(wall, processor))


def test_jobs_of_a_run_are_summed_by_stage(tmp_path):
    leave(tmp_path, "figs/curve.tsv", processor=3.0)
    leave(tmp_path, "truth/iss.tsv", processor=4.0)
    leave(tmp_path, "truth/together/lares.tsv", processor=5.0)
    leave(tmp_path, "reproduction.tsv", wall=0.3, processor=0.0)  # Snakemake did not see it
    found = {one.stage: (one.jobs, one.processor) for one in paper.costs(tmp_path)}
    assert found == {
        "truth": (2, 9.0),
        paper.REST: (2, pytest.approx(3.3)),
        "together": (4, pytest.approx(12.3)),
    }
    assert "| truth | 2 | 9 | 4.50 | 0.1 |" in paper.report(paper.costs(tmp_path))


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
