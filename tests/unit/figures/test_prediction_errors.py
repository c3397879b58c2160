"""The figures of prediction errors: the values they draw, their labels, and stable bytes."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from drawing import assert_inside, assert_same_in_another_process
from matplotlib.colors import to_rgba
from support import refusal

from opml.base.constants import DAY
from opml.figures import axis_labels, notes, prediction_errors, style
from opml.learning.data.cleaning import Cleaning
from opml.learning.judge import metrics
from opml.naming import Experiment


def table(duration_days, true, predicted):
    true, predicted = np.array(true, dtype=float), np.array(predicted, dtype=float)
    count = np.arange(len(true))
    return pd.DataFrame(
        {
            "i": count,
            "j": count + 1,
            "duration": np.array(duration_days) * DAY,
            "true": true,
            "predicted": predicted,
            "residual": true - predicted,
        }
    )


@pytest.fixture
def evaluation():
    # Two clusters of five points, and one point alone that makes none.
    duration = [0.05, 0.10, 0.15, 0.20, 0.25, 1.01, 1.02, 1.03, 1.04, 1.05, 3.0]
    true = [1000, -2000, 3000, -4000, 5000, 10000, 10000, 10000, -10000, -10000, 7000]
    predicted = [500, -2000, 2000, -5000, 5000, 9000, 12000, 10000, -7000, -10000, 0]
    return table(duration, true, predicted)


@pytest.fixture
def pairs():
    columns = {f"e_{axis}": np.array([1.0, -20.0, np.nan, 300.0]) * k for k, axis in enumerate("xyz", 1)}
    columns |= {f"e_v{axis}": np.array([0.5, -1.5, np.nan, 2.5]) * k for k, axis in enumerate("xyz", 1)}
    t_j = np.array([1.0, 2.0, 2.5, 4.0]) * DAY
    return pd.DataFrame({"t_i": np.full(4, 0.5 * DAY), "t_j": t_j, **columns})


def bars(axes):
    """(durations, means, bars' ends) by label of what `errorbar` drew."""
    return {
        container.get_label(): (
            np.asarray(container[0].get_xdata()),
            np.asarray(container[0].get_ydata()),
            np.array([segment[:, 1] for segment in container[2][0].get_segments()]),
        )
        for container in axes.containers
    }


def points(figure):
    """The points of the true, the predicted and the residual errors, a panel each, of a figure with bars."""
    return [axes.collections[0] for axes in figure.axes[:3]]


def texts(figure):
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def test_clusters_by_hand(evaluation):
    found = prediction_errors.clusters(evaluation["duration"].to_numpy() / DAY, evaluation["true"].to_numpy())
    assert found["duration"].tolist() == pytest.approx([0.15, 1.03])
    assert found["mean"].tolist() == pytest.approx([600.0, 2000.0])
    # Squares about 600: 0.16, 6.76, 5.76, 21.16, 19.36 in 1e6; about 2000: 3 x 64, 2 x 144; over n - 1.
    assert found["std"].tolist() == pytest.approx([np.sqrt(53.2e6 / 4), np.sqrt(480e6 / 4)])


def test_a_cluster_ends_with_its_last_instant():
    duration = np.array([0.25] * 5 + [0.2500001] * 5)
    assert prediction_errors.clusters(duration, np.arange(10.0))["mean"].tolist() == [2.0, 7.0]


def test_all_points_on_the_left(evaluation):
    left = points(prediction_errors.svr_absolute(evaluation))
    offsets = [np.asarray(one.get_offsets()) for one in left]
    for drawn, column in zip(offsets, ("true", "predicted", "residual"), strict=True):
        assert drawn[:, 0] == pytest.approx(evaluation["duration"] / DAY)
        assert drawn[:, 1] == pytest.approx(evaluation[column].abs() / 1e3)
    assert all(one.get_rasterized() for one in left)
    signed = points(prediction_errors.svr_signed(evaluation))[2].get_offsets()
    assert np.asarray(signed)[:, 1] == pytest.approx(evaluation["residual"] / 1e3)


def test_one_colour_one_meaning(evaluation):
    figure = prediction_errors.svr_absolute(evaluation)
    right = figure.axes[-1]
    colors = [style.TRUE_COLOR, style.PREDICTED_COLOR, style.RESIDUAL]
    assert [container[0].get_color() for container in right.containers] == colors
    true, predicted, residual = points(figure)
    assert len(true.get_facecolor()) == 0  # hollow
    assert tuple(true.get_edgecolor()[0]) == to_rgba(style.TRUE_COLOR)
    assert tuple(predicted.get_facecolor()[0]) == to_rgba(style.PREDICTED_COLOR)
    assert tuple(residual.get_facecolor()[0]) == to_rgba(style.RESIDUAL)


@pytest.mark.parametrize("draw", [prediction_errors.svr_absolute, prediction_errors.errorbar_absolute])
def test_error_bars_by_hand(evaluation, draw):
    drawn = bars(draw(evaluation).axes[-1])
    assert [label.split()[0] for label in drawn] == ["true", "ML-predicted", "residual"]
    duration, mean, ends = drawn["true $e_{y}$"]
    assert mean == pytest.approx([3.0, 10.0])  # of 1, 2, 3, 4, 5 and of five times 10
    assert ends[0] == pytest.approx([3.0 - np.sqrt(2.5), 3.0 + np.sqrt(2.5)])
    assert ends[1] == pytest.approx([10.0, 10.0])
    residual = drawn[r"residual $e_{\mathrm{res}}$"]
    assert residual[1] == pytest.approx([0.5, 1.2])  # of 0.5, 0, 1, 1, 0 and of 1, 2, 0, 3, 0
    # Displaced to either side of the ML-predicted curve, by less than half a cluster.
    middle = drawn[r"ML-predicted $\hat{e}_{\mathrm{ML},y}$"][0]
    assert middle == pytest.approx([0.15, 1.03])
    assert duration - middle == pytest.approx(middle - residual[0])
    assert np.all((duration < middle) & (middle - duration < prediction_errors.CLUSTER_DAYS / 2))


def test_signed_bars(evaluation):
    _, mean, _ = bars(prediction_errors.svr_signed(evaluation).axes[-1])["true $e_{y}$"]
    assert mean == pytest.approx([0.6, 2.0])


def test_metrics_are_those_of_the_learning(evaluation):
    true, predicted = evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy()
    # Residuals 500, 0, 1000, 1000, 0, 1000, 2000, 0, 3000, 0, 7000 of errors that sum to 72000.
    assert metrics.p_ml(true, predicted) == pytest.approx(100 * 15500 / 72000)
    for draw in (
        prediction_errors.svr_absolute,
        prediction_errors.svr_signed,
        prediction_errors.errorbar_absolute,
    ):
        assert any(text.endswith("= 21.5 %") for text in texts(draw(evaluation)))
    odd = table([1.0] * 4, [0.0, 0.0, 2.0, -4.0], [0.0, 1.0, 1.0, 4.0])
    found = prediction_errors._individual_p_ml(odd)
    assert found.tolist() == [0.0, np.inf, 50.0, 200.0]
    assert (
        found.tolist()
        == metrics.individual_p_ml(odd["true"].to_numpy(), odd["predicted"].to_numpy()).tolist()
    )


def test_units_follow_the_component(evaluation):
    left, *others, right = prediction_errors.svr_absolute(evaluation).axes
    for axes in others:
        assert axes.get_xlabel() == left.get_xlabel()
        assert axes.get_ylim() == left.get_ylim()
    for axes in (left, right):
        assert axes.get_ylabel() == "along-track error $|e_{y}|$ [km]"
        assert axes.get_xlabel() == r"prediction duration $\Delta t$ [d]"
    velocity = prediction_errors.svr_signed(evaluation, component="e_vx")
    assert velocity.axes[0].get_ylabel() == "radial velocity error $e_{vx}$ [m/s]"
    assert np.asarray(velocity.axes[0].collections[0].get_offsets())[0, 1] == 1000.0
    assert "true $e_{vx}$" in bars(velocity.axes[-1])


def test_grid_has_a_panel_each(evaluation):
    half = evaluation.assign(predicted=evaluation["true"] / 2, residual=evaluation["true"] / 2)
    figure = prediction_errors.rso_grid({"SWARM-A": evaluation, "LARES": half, "LAGEOS-1": evaluation})
    titles = [axes.get_title(loc="left").splitlines() for axes in figure.axes]
    assert titles == [["SWARM-A", ""], ["LARES", ""], ["LAGEOS-1", ""]]
    assert [text.split("= ")[1] for text in texts(figure)] == ["21.5 %", "50.0 %", "21.5 %"]
    assert bars(figure.axes[1])[r"residual $e_{\mathrm{res}}$"][1] == pytest.approx([1.5, 5.0])
    head = "22 % (LAGEOS-1) to 50 % (LARES) of the error remains\n"
    assert figure.get_suptitle().startswith(head)
    assert "at least one evaluation" in refusal(prediction_errors.rso_grid, {})


def test_individual_points_are_sorted_out():
    # p_ML of 50, 100, 150, 800 %, and infinite: the one left alone is neither reduced nor increased.
    points = table([1, 2, 3, 4, 5], [1000, 2000, -2000, 100, 0], [500, 0, 1000, 900, 300])
    reduced, increased = (
        prediction_errors.individual_reduced(points),
        prediction_errors.individual_increased(points),
    )
    true, residual = reduced.axes[0].collections
    assert np.asarray(true.get_offsets()).tolist() == [[1.0, 1.0]]
    assert np.asarray(residual.get_offsets()).tolist() == [[1.0, 0.5]]
    assert residual.get_array().tolist() == [50.0]
    assert residual.get_clim() == (0.0, 100.0)
    true, residual = increased.axes[0].collections
    assert np.asarray(true.get_offsets()).tolist() == [[3.0, 2.0], [4.0, 0.1], [5.0, 0.0]]
    assert np.asarray(residual.get_offsets())[:, 1] == pytest.approx([3.0, 0.8, 0.3])
    assert residual.get_array().tolist() == [150.0, 800.0, 1000.0]  # infinity would have no colour
    beyond = residual.to_rgba(np.array([501.0, 800.0, 1000.0]))
    assert (beyond == to_rgba(prediction_errors.BEYOND_COLOR)).all()
    assert tuple(residual.to_rgba(499.0)) != to_rgba(prediction_errors.BEYOND_COLOR)
    assert reduced.axes[0].collections[1].get_cmap() != residual.get_cmap()
    assert reduced.get_suptitle().startswith("1 of 5 errors are reduced\n")
    assert reduced.axes[1].get_ylabel() == r"$p_{\mathrm{ML}}$ [%]"


def test_no_increased_point_is_no_failure(tmp_path):
    perfect = table([1.0, 2.0], [5.0, 6.0], [5.0, 6.0])
    figure = prediction_errors.individual_increased(perfect)
    assert figure.get_suptitle().startswith("0 of 2 errors are increased\n")
    style.save(figure, tmp_path / "a.pdf", tmp_path / "a.png")


def test_distribution_of_individual_metric():
    points = table([1.0] * 5, [100.0] * 5, [100.0, 70.0, 5.0, 0.0, -300.0])  # 0, 30, 95, 100, 400 %
    figure = prediction_errors.individual_distribution(points)
    curve = figure.axes[0].get_lines()[0]
    share = dict(zip(curve.get_xdata(), curve.get_ydata(), strict=True))
    at = (0.0, 1.0, 30.0, 31.0, 100.0, 101.0, 400.0, 401.0)
    assert [share[limit] for limit in at] == pytest.approx([0, 20, 20, 40, 60, 80, 80, 100])
    assert texts(figure) == ["60.0 % of the points\nbelow 100 %"]
    assert figure.get_suptitle().startswith("60.0 % of the errors are reduced\n")
    assert figure.texts[-1].get_text() == "5 predictions"
    assert figure.axes[0].get_legend() is None
    compared = prediction_errors.individual_distribution(points, published=80.0).axes[0]
    assert compared.get_legend_handles_labels()[1] == ["Peng & Bai, about 80 %"]
    assert (compared.lines[-1].get_xdata()[0], compared.lines[-1].get_ydata()[0]) == (100.0, 80.0)


def head(figure):
    """Return the note under a figure's headline, in one line."""
    return " ".join(figure.texts[-1].get_text().split())


def test_distribution_of_position(pairs):
    figure = prediction_errors.distribution_position(pairs)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "radial error $|e_{x}|$ [km]",
        "along-track error $|e_{y}|$ [km]",
        "cross-track error $|e_{z}|$ [km]",
    ]
    headline = "Median errors [km]: radial 0.02, along-track 0.04, cross-track 0.06"
    assert figure.get_suptitle().strip() == headline
    for k, axes in enumerate(figure.axes, 1):
        drawn = np.asarray(axes.collections[0].get_offsets())
        assert drawn[:, 0] == pytest.approx([0.5, 1.5, 3.5])  # the pair without a prediction is left out
        assert drawn[:, 1] == pytest.approx(np.array([0.001, 0.02, 0.3]) * k)
        assert axes.get_yscale() == "log"


def test_distribution_of_velocity(pairs):
    figure = prediction_errors.distribution_velocity(pairs)
    assert figure.axes[1].get_ylabel() == "along-track velocity error $e_{vy}$ [m/s]"
    drawn = np.asarray(figure.axes[1].collections[0].get_offsets())
    assert drawn[:, 1] == pytest.approx([1.0, -3.0, 5.0])
    assert figure.axes[1].get_yscale() == "linear"


EXPERIMENT = Experiment("iss", "eglin", "days-0-30", "svr", "e_y", "lares", "days-30-40-unseen")


@pytest.fixture
def told():
    """The context of an evaluation: rows from -20 to 20 km, of which the fences keep most."""
    e_y = np.append(np.arange(-10.0, 11.0) * 1e3, [90e3, np.nan])
    reason = np.array([""] * 21 + ["outside Tukey fences", "no prediction: decayed"])
    dataset = pd.DataFrame({"e_y": e_y, "reason": reason, "keep": reason == "", "t_j": 31.0 * DAY})
    metrics = pd.DataFrame({"p_ml_low": [20.1], "p_ml_high": [23.4]})
    return notes.experiment_context(EXPERIMENT, Cleaning(fence=1.0), metrics, dataset)


def test_the_context_says_what_was_trained_and_tested_and_which_rows_there_are(told):
    assert told.note == (
        "ISS-based RSO by one radar (Eglin); the paper's SVR trained on days 0 to 30, tested on LARES, "
        "days 30 to 40, new estimates only"
    )
    assert told.kept == pytest.approx(100.0 * 21 / 23)
    earlier = pd.DataFrame({"keep": [True, False, False], "t_j": [31.0 * DAY, 35.0 * DAY, 20.0 * DAY]})
    assert notes.kept_share(earlier, "days-30-40") == 0.5
    assert notes.kept_share(earlier, "rest") == pytest.approx(1 / 3)
    # Hazen's quartiles of -10, -9, ..., 10 and 90: the 6th and the 17th.
    assert told.fences == pytest.approx((-5e3 - 11e3, 6e3 + 11e3))
    unfenced = replace(EXPERIMENT, test="days-30-40-unfenced")
    dataset = pd.DataFrame({"e_y": [1.0], "reason": [""], "keep": [True], "t_j": [1.0]})
    metrics = pd.DataFrame({"p_ml_low": [1.0], "p_ml_high": [2.0]})
    assert notes.experiment_context(unfenced, Cleaning(fence=1.0), metrics, dataset).fences is None
    assert notes.experiment_context(EXPERIMENT, Cleaning(), metrics, dataset).fences is None


@pytest.mark.parametrize(
    ("describe", "name", "words"),
    [
        (axis_labels.describe_training, "random-80_split43", "80 % of the predictions"),
        (axis_labels.describe_training, "grouped-80", "80 % of the estimates"),
        (axis_labels.describe_training, "days-0-30", "days 0 to 30"),
        (axis_labels.describe_test, "rest", "the rest"),
        (axis_labels.describe_test, "seen", "the same rows"),
        (axis_labels.describe_test, "days-30-40-unfenced", "days 30 to 40, no fences"),
        (axis_labels.describe_test, "days-30-40-fence3", "days 30 to 40, fences of its own"),
    ],
)
def test_trained_and_tested_rows_in_words(describe, name, words):
    assert describe(name) == words


def test_the_context_stands_in_the_figure(evaluation, told):
    figure = prediction_errors.svr_absolute(evaluation, context=told)
    note = head(figure)
    assert figure.get_suptitle().startswith("Corrected along-track errors are 22 % of the uncorrected\n")
    assert "trained on days 0 to 30" in note
    assert "dashed: \N{MINUS SIGN}16.0 and 17.0 km, beyond which the cleaning drops true errors" in note
    for axes in figure.axes[:3]:
        (fence,) = (line for line in axes.lines if line.get_linestyle() == "--")
        assert fence.get_ydata()[0] == pytest.approx(17.0)
    signed = prediction_errors.svr_signed(evaluation, context=told).axes[0]
    drawn = {line.get_ydata()[0] for line in signed.lines if line.get_linestyle() == "--"}
    assert sorted(drawn) == pytest.approx([-16.0, 17.0])
    assert texts(figure)[-1].endswith("= 21.5 % (90 %: 20.1 to 23.4)")
    title = figure.axes[-1].get_title(loc="right")
    assert "91.3 % of the pairs are kept" in title
    # Of the five up to half a day: 1000 to 5000 before, 500, 0, 1000, 1000 and 0 after.
    assert "predictions of only 11 estimates" in title
    assert title.endswith("up to 0.5 d the mean size falls from 3000 to 500 m")


def test_a_test_without_fences_keeps_what_they_alone_drop():
    reason = ["", "outside Tukey fences", "no prediction: decayed", ""]
    dataset = pd.DataFrame({"reason": reason, "t_j": 31.0 * DAY}).assign(keep=[True, False, False, True])
    assert notes.kept_share(dataset, "days-30-40") == 0.5
    assert notes.kept_share(dataset, "days-30-40-unfenced") == 0.75


def test_p_ml_stands_above_the_bars(evaluation, told):
    for draw in (prediction_errors.svr_signed, prediction_errors.errorbar_absolute):
        figure = draw(evaluation, context=told)
        figure.draw_without_rendering()
        axes = figure.axes[-1]
        (text,) = axes.texts
        lowest = axes.transData.inverted().transform(text.get_window_extent())[0, 1]
        assert lowest > max(ends.max() for *_, ends in bars(axes).values())
        assert text.get_window_extent().x1 <= figure.bbox.x1


def test_no_line_crosses_durations_without_points():
    duration, values = prediction_errors._break_gaps(np.array([0.1, 0.3, 0.9]), np.array([1.0, 2.0, 3.0]))
    assert duration == pytest.approx([0.1, 0.3, np.nan, 0.9], nan_ok=True)
    assert values == pytest.approx([1.0, 2.0, np.nan, 3.0], nan_ok=True)


def test_points_below_a_logarithmic_axis_are_counted(evaluation):
    # Predicted and residual errors have one zero and four, which no logarithmic axis shows.
    assert head(prediction_errors.svr_absolute(evaluation)).endswith("5 points lie below the axis")
    one = evaluation.assign(residual=evaluation["residual"].replace(0.0, 1.0))
    assert head(prediction_errors.svr_absolute(one)).endswith("1 point lies below the axis")
    assert "below the axis" not in head(prediction_errors.svr_signed(evaluation))


def test_a_model_that_says_one_thing_is_said_to(evaluation):
    assert notes.constant_note(evaluation, "e_y") == ""
    found = notes.constant_note(evaluation.assign(predicted=-1400.0), "e_y")
    assert "nearly one value, 1400 m in size" in found


def test_a_legend_shows_each_thing_once_under_the_note_within_the_width(evaluation, told):
    figure = prediction_errors.rso_grid({"a": evaluation, "b": evaluation}, contexts={"a": told, "b": told})
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 3
    assert head(figure).count("trained on") == 1
    narrow = prediction_errors.errorbar_absolute(evaluation, context=told)
    assert narrow.get_suptitle().startswith("22 % of the error remains\n")
    narrow.draw_without_rendering()
    assert narrow.legends[0].get_window_extent().x1 <= narrow.bbox.x1


def test_nothing_to_draw(evaluation, pairs):
    for draw in (
        prediction_errors.svr_absolute,
        prediction_errors.svr_signed,
        prediction_errors.errorbar_absolute,
        prediction_errors.individual_reduced,
        prediction_errors.individual_increased,
        prediction_errors.individual_distribution,
    ):
        assert "expected at least one row" in refusal(draw, evaluation.iloc[:0])
    assert "expected at least one row" in refusal(prediction_errors.distribution_position, pairs.iloc[2:3])


def test_everything_stays_inside(evaluation, pairs):
    for width, figure in (
        (180.0, prediction_errors.svr_absolute(evaluation)),
        (180.0, prediction_errors.svr_signed(evaluation, component="e_vx")),
        (180.0, prediction_errors.rso_grid({"SWARM-A": evaluation, "LARES": evaluation})),
        (180.0, prediction_errors.distribution_position(pairs)),
        (88.0, prediction_errors.errorbar_absolute(evaluation, component="e_vx")),
        (88.0, prediction_errors.individual_increased(evaluation, component="e_vx")),
        (88.0, prediction_errors.individual_distribution(evaluation)),
    ):
        assert figure.get_figwidth() == pytest.approx(width / 25.4)
        assert_inside(figure)


@pytest.mark.slow
def test_same_bytes_in_another_process(evaluation, tmp_path):
    draws = [prediction_errors.svr_absolute, prediction_errors.individual_increased]
    assert_same_in_another_process(draws, evaluation, tmp_path)


@pytest.mark.slow
def test_many_points_make_a_small_file(tmp_path):
    rng = np.random.default_rng(1)
    true = rng.normal(size=20_000) * 1e4
    many = table(rng.uniform(0.1, 7.0, 20_000), true, true * 0.9)
    style.save(prediction_errors.svr_absolute(many), tmp_path / "f.pdf", tmp_path / "f.png")
    assert (tmp_path / "f.pdf").stat().st_size < 1_000_000
