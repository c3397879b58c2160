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


def test_a_split_is_drawn_at_its_share_whatever_its_seed(metrics):
    named = metrics.assign(
        train=metrics["train"].where(metrics["test"] == "seen", metrics["train"] + "_split43")
    )
    assert lines(p_ml_curves.partition_curve(named)) == lines(p_ml_curves.partition_curve(metrics))


def test_rows_of_different_things_are_not_averaged(transfers):
    with pytest.raises(InputError, match="expected one row per point"):
        inclination_curve(pd.concat([transfers, transfers]))


def test_everything_stays_inside_the_column(metrics, transfers):
    published = {test: {50.0: 40.2} for test in ("days-30-40", "days-30-50")}
    for figure in (
        p_ml_curves.partition_curve(metrics, published=PUBLISHED),
        inclination_curve(transfers, published=published),
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
