"""The curves of P_ML: what they draw, and that their files are the same bytes each time."""

import pandas as pd
import pytest
from drawing import assert_inside, assert_same_in_another_process

from opml.base.errors import InputError
from opml.figures import p_ml_curves, style

PUBLISHED = {40: 14.8, 80: 9.6, 90: 9.7}


@pytest.fixture
def metrics():
    rows = [
        {
            "train": f"random-{share}",
            "component": component,
            "test": test,
            "p_ml": factor * 200.0 / (share + 5),
        }
        for share in (90, 10, 50)  # out of order on purpose
        for component in ("e_y", "e_vx")
        for test, factor in (("rest", 1.0), ("seen", 0.5))
    ]
    rows.append({"train": "days-0-30", "component": "e_y", "test": "days-30-40", "p_ml": 999.0})
    return pd.DataFrame(rows)


def lines(figure):
    axes = figure.axes[0]
    return {line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in axes.get_lines()}


def test_draws_the_test_part_in_order(metrics):
    figure = p_ml_curves.partition_curve(metrics, published=PUBLISHED)
    drawn = lines(figure)
    assert figure.get_suptitle().startswith("Trained on 90 %, 2 % of the error remains\n")
    assert drawn["test part"] == ([10.0, 50.0, 90.0], pytest.approx([200 / 15, 200 / 55, 200 / 95]))
    assert drawn["training part"][1] == pytest.approx([100 / 15, 100 / 55, 100 / 95])
    assert drawn["Peng & Bai, test part"] == ([40, 80, 90], [14.8, 9.6, 9.7])


def test_draws_what_is_at_hand(metrics):
    figure = p_ml_curves.partition_curve(metrics[metrics["test"] == "rest"], component="e_vx")
    assert list(lines(figure)) == ["test part"]
    assert "e_{vx}" in figure.axes[0].get_ylabel()
    assert "[%" in figure.axes[0].get_xlabel()


def test_nothing_to_draw(metrics):
    with pytest.raises(InputError, match="partition curve: expected metrics of e_z"):
        p_ml_curves.partition_curve(metrics, component="e_z")


INCLINATIONS = {"iss_i50": 50.0, "iss": 51.6393, "iss_i48": 48.0}


@pytest.fixture
def transfers():
    """Future windows of three targets, and rows that no curve over targets may draw."""
    rows = [
        {"train": "days-0-30", "test": test, "target": target, "component": "e_y", "p_ml": p_ml + further}
        for test, further in (("days-30-40", 0.0), ("days-30-50", 100.0))
        for target, p_ml in (("iss", 35.0), ("iss_i50", 40.0), ("iss_i48", 50.0), ("lares", 999.0))
    ]
    rows.append({**rows[0], "component": "e_x", "p_ml": 999.0})
    rows.append({**rows[0], "test": "rest", "p_ml": 999.0})
    return pd.DataFrame(rows).assign(rso="iss", stations="eglin", learner="svr")


def inclination_curve(metrics, **options):
    return p_ml_curves.transfer_curve(metrics, "inclination", INCLINATIONS, **options)


def with_seeds(metrics, offsets):
    copies = [metrics.assign(seed=seed, p_ml=metrics["p_ml"] + k) for seed, k in enumerate(offsets)]
    return pd.concat(copies, ignore_index=True)


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_curve_each_window(transfers):
    figure = inclination_curve(transfers, published={"days-30-40": {50.0: 40.2}})
    drawn = lines(figure)
    assert drawn["days 30 to 40"] == ([48.0, 50.0], [50.0, 40.0])
    assert drawn["days 30 to 50"][1] == [150.0, 140.0]
    apart = drawn["days 30 to 50"][0][0] - 48.0
    assert 0.0 < apart < 0.1 * (51.6393 - 48.0)  # equal points of two windows are both seen
    assert drawn["Peng & Bai"] == ([50.0], [40.2])
    assert figure.get_suptitle().startswith("Other RSOs: 40 to 150 % of the error remains")
    assert figure.axes[0].get_xlabel() == "inclination $i$ [deg]"
    markers = {line.get_label(): line for line in figure.axes[0].get_lines()}
    theirs = markers["Peng & Bai"]
    assert theirs.get_marker() == "D"
    assert theirs.get_markerfacecolor() == "none"


def test_no_line_joins_the_rso_trained_on_to_others(transfers):
    drawn = inclination_curve(transfers).axes[0].get_lines()
    points = [line for line in drawn if list(line.get_ydata()) in ([35.0], [135.0])]
    assert [line.get_linestyle() for line in points] == ["None", "None"]


def test_over_semi_major_axis(transfers):
    figure = p_ml_curves.transfer_curve(transfers, "semi_major_axis", {"iss_i50": 0.0, "lares": 50.0})
    assert lines(figure)["days 30 to 40"] == ([0.0, 50.0], [40.0, 999.0])
    assert figure.axes[0].get_xlabel() == "increment of the semi-major axis $a$ [km]"


def test_no_target_to_draw(transfers):
    with pytest.raises(InputError, match="future windows of stella, got none"):
        p_ml_curves.transfer_curve(transfers, "semi_major_axis", {"stella": 10.0})


def test_no_correction_is_marked_in_range(transfers):
    def marked(metrics):
        figure = inclination_curve(metrics)
        return any(
            list(line.get_ydata()) == [100.0, 100.0] and line.get_linestyle() == "--"
            for line in figure.axes[0].get_lines()
        )

    assert marked(transfers)
    assert not marked(transfers[transfers["test"] == "days-30-40"])


def test_seeds_make_a_band(transfers):
    figure = inclination_curve(with_seeds(transfers, (0.0, 1.0, 5.0)))
    assert lines(figure)["days 30 to 40"][1] == pytest.approx([52.0, 42.0])
    band = figure.axes[0].collections[1].get_paths()[0].vertices
    at_50 = sorted({round(y, 9) for x, y in band if x == 50.0})
    assert at_50 == pytest.approx([42.0 - 7.0**0.5, 42.0 + 7.0**0.5])  # of 40, 41, 45 over n - 1
    assert "\nmean and standard deviation of 3 seeds" in figure.texts[-1].get_text()


def test_seeds_of_the_partition_curve(metrics):
    figure = p_ml_curves.partition_curve(with_seeds(metrics, (0.0, 2.0)))
    assert lines(figure)["test part"][1] == pytest.approx([200 / 15 + 1, 200 / 55 + 1, 200 / 95 + 1])
    assert len(figure.axes[0].collections) == 2


def test_a_split_is_drawn_at_its_share_whatever_its_seed(metrics):
    named = metrics.assign(
        train=metrics["train"].where(metrics["test"] == "seen", metrics["train"] + "_split43")
    )
    assert lines(p_ml_curves.partition_curve(named)) == lines(p_ml_curves.partition_curve(metrics))


def test_one_seed_makes_no_band(transfers):
    figure = inclination_curve(with_seeds(transfers, (0.0,)))
    assert len(figure.axes[0].collections) == 0
    assert figure.legends[0].get_title().get_text() == ""


def test_rows_of_different_things_are_not_averaged(transfers):
    with pytest.raises(InputError, match="expected one row per point and seed"):
        inclination_curve(pd.concat([transfers, transfers]))


@pytest.fixture
def scales():
    splits = (
        ("random-80", "rest"),
        ("grouped-80", "rest"),
        ("days-0-30", "days-30-40"),
        ("random-50", "days-30-40"),
    )
    rows = [
        {
            "stations": stations,
            "train": train,
            "test": test,
            "component": "e_y",
            "kernel_scale": scale,
            "p_ml": 10.0 * k + scale + more,
        }
        for stations, more in (("eglin", 0.0), ("eglin-clear", 60.0))
        for scale in (8.0, 1.0, 2.0)
        for k, (train, test) in enumerate(splits)
    ]
    return pd.DataFrame(rows)


def test_kernel_scale_by_station_set_and_split_with_the_rules(scales):
    rules = {"eglin": {"sigest": 3.456}, "eglin-clear": {"sigest": 4.0, "median": 5.0}}
    figure = p_ml_curves.kernel_scale_sensitivity(scales, rules)
    one, two = (
        {line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in axes.get_lines()}
        for axes in figure.axes
    )
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "one radar (Eglin)",
        "two radars (Eglin, Clear)",
    ]
    assert one["random 80 %, test part"] == ([1.0, 2.0, 8.0], [1.0, 2.0, 8.0])
    assert one["grouped 80 %, test part"][1] == [11.0, 12.0, 18.0]
    assert one["days 30 to 40"][1] == [21.0, 22.0, 28.0]
    assert two["random 50 %, days-30-40"][1] == [91.0, 92.0, 98.0]
    assert one["$s$ by sigest"][0] == [3.456, 3.456]
    assert two["$s$ by median"][0] == [5.0, 5.0]
    assert "$s$ by median" not in one
    assert len(legend(figure)) == 7
    assert "no correction" in legend(figure)
    assert all(axes.get_xscale() == "log" and axes.get_ylim()[1] > 98.0 for axes in figure.axes)


def test_kernel_scale_without_rows(scales):
    with pytest.raises(InputError, match="expected metrics of e_z"):
        p_ml_curves.kernel_scale_sensitivity(scales, {}, component="e_z")


def test_everything_stays_inside_the_column(metrics, transfers, scales):
    published = {test: {50.0: 40.2} for test in ("days-30-40", "days-30-50")}
    rules = {"eglin": {"sigest": 3.5, "median": 5.0}}
    for figure in (
        p_ml_curves.partition_curve(metrics, published=PUBLISHED),
        inclination_curve(with_seeds(transfers, (0.0, 1.0)), published=published),
        p_ml_curves.kernel_scale_sensitivity(scales, rules),
    ):
        assert_inside(figure)
        assert figure.get_figwidth() in (pytest.approx(88.0 / 25.4), pytest.approx(180.0 / 25.4))


@pytest.mark.slow
def test_same_bytes_in_another_process(metrics, tmp_path):
    assert_same_in_another_process([p_ml_curves.partition_curve], metrics, tmp_path)


def test_failed_save_leaves_nothing(metrics, tmp_path):
    figure = p_ml_curves.partition_curve(metrics)
    figure.axes[0].set_xlabel(r"$\frac{$")  # text that cannot be set
    with pytest.raises(ValueError, match="frac"):
        style.save(figure, tmp_path / "c.pdf", tmp_path / "c.png")
    assert list(tmp_path.iterdir()) == []
