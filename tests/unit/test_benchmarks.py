"""The benchmarks' arithmetic and tables, on made-up numbers; the peers are not needed."""

import numpy as np
import pytest

from benchmarks import measure, paper, race, svr
from benchmarks.kernels import Machine, Work
from opml.elements import cartesian_from_coe
from opml.errors import InputError

GM = 3.986004418e14


def result(title, cpu, *, vacuum=10.0, drag=1.0):
    about = {"title": title, "integrator": "steps", "model": "forces"}
    return race.Result(
        about, arcs=100, cpu=cpu, wall=cpu, own_error=1.0, vacuum=vacuum, drag=drag, apart=20.0
    )


def test_cost_is_spread_over_arcs_and_days():
    assert measure.per_arc_day(7.0, 100 * 7) == 10.0


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
    assert "| heyoka: steps | 100 | 52 | 52 | 26 | 1.0 |" in text
    assert "Not run: orekit (no data)." in text
    assert "disagrees" not in text


@pytest.mark.parametrize("off", [{"vacuum": 600.0}, {"drag": 1.2}])
def test_answers_that_models_do_not_explain_are_told(off):
    results = {race.OURS: result("opml", [2.0]), "heyoka": result("heyoka", [50.0], **off)}
    assert race.disagreements(results) == ["heyoka"]
    assert "**heyoka disagrees" in race.report(results, {})


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
    with pytest.raises(InputError, match=r"iss\.tsv: expected a benchmark with cpu_time and s"):
        paper.costs(tmp_path)


def test_the_solver_stands_beside_libsvm():
    settings = {"kernel_scale": "sigest", "c": 1.0, "epsilon": 0.1, "tol": 1e-5}
    text = svr.compare(svr._made_up(rows=200, count=4), settings)
    lines = {line.split(" | ")[0]: line.split(" | ")[5:] for line in text.splitlines() if " | " in line}
    assert lines["| opml"] == lines["| scikit-learn (libsvm)"]  # support vectors and P_ML
