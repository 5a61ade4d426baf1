"""All edges of a target: found, grouped, averaged, and consistent."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Estimate
from acutance.report import document as document_of
from acutance.report import json_text
from acutance.report.tables.target import group_rows
from acutance.simulate import site
from acutance.targets.straight.many_edges import (
    TargetResult,
    _border,
    _chance,
    _shared,
    _weighted_mean,
    combine_edges,
)

SYSTEM = ac.Sensor(
    [ac.optics.Gaussian(0.4), ac.optics.Detector(1.0), ac.optics.Smear(0.5, "along")]
)


def weighted_mean(numbers, common):
    """Of numbers whose part that is common to all is known."""
    return _weighted_mean(numbers, common, common)


@pytest.fixture(scope="module")
def scene():
    return site(SYSTEM, np.random.default_rng(4))


@pytest.fixture
def edge_seen_by():
    def measured(sensor, seed, edit=lambda image: image):
        image, _ = ac.simulate.edge(
            sensor, angle_deg=8, snr=80, dark=200, bright=1000, shape=(48, 48),
            rng=np.random.default_rng(seed),
        )  # fmt: skip
        return ac.measure_edge(edit(image))

    return measured


def test_a_checkerboard_gives_its_four_edges(scene):
    result = ac.measure_edges(scene.image)
    assert len(result.measurements) == 4
    assert {key: len(group.measurements) for key, group in result.groups.items()} == {
        "across": 2,
        "along": 2,
    }
    for m in result.measurements:
        truth = min(
            (one.truth for one in scene.edges),
            key=lambda one: math.hypot(one.line.row - m.line.row, one.line.col - m.line.col),
        )
        assert m.orientation == truth.orientation
        assert abs(m.mtf_nyquist.value - truth.mtf_nyquist.value) < 4 * m.mtf_nyquist.std
        assert abs(m.rer.value - truth.rer.value) < 4 * m.rer.std


def test_group_means_are_better_than_their_edges_and_consistent(scene):
    for group in ac.measure_edges(scene.image).groups.values():
        stds = [m.mtf_nyquist.std for m in group.measurements]
        assert group.metrics["mtf_nyquist"].std < 1.5 * min(stds)
        assert group.degrees_of_freedom == 1
        assert group.p_value["mtf_nyquist"] > 1e-3


def test_means_in_metres_are_those_in_pixels(scene):
    gsd_m = 0.3
    (group, *_) = ac.measure_edges(scene.image, gsd_m=gsd_m).groups.values()
    pixels, metres = group.metrics["fwhm_px"], group.metrics["fwhm_m"]
    assert metres.value == pytest.approx(gsd_m * pixels.value)
    assert metres.std == pytest.approx(gsd_m * pixels.std)


def test_border_edges_are_rejected_with_their_reason(scene):
    result = ac.measure_edges(scene.image)
    reasons = [one for one in result.rejected if one.stage == "contrast"]
    assert reasons
    assert all("probably not of the target" in one.reason for one in reasons)
    assert all({"row", "col", "normal_deg"} <= set(one.values) for one in reasons)


def test_an_image_without_edges_gives_an_empty_result():
    result = ac.measure_edges(np.random.default_rng(0).normal(100, 1, (60, 60)))
    assert result.measurements == ()
    assert result.groups == {}


def test_weighted_mean_and_chi_square():
    mean, chi_square = weighted_mean([Estimate(1.0, 0.1), Estimate(1.3, 0.2)], np.zeros(2))
    assert mean.value == pytest.approx((1.0 / 0.01 + 1.3 / 0.04) / (1 / 0.01 + 1 / 0.04))
    assert chi_square == pytest.approx(
        (1.0 - mean.value) ** 2 / 0.01 + (1.3 - mean.value) ** 2 / 0.04
    )
    # chi-square 1.8 with one degree of freedom: the Birge ratio widens the mean's deviation.
    assert mean.std == pytest.approx(math.sqrt(chi_square) / math.sqrt(125))
    agreeing, small = weighted_mean([Estimate(1.0, 0.1), Estimate(1.01, 0.1)], np.zeros(2))
    assert small < 1
    assert agreeing.std == pytest.approx(0.1 / math.sqrt(2))
    common, _ = weighted_mean([Estimate(1.0, 0.1), Estimate(1.01, 0.1)], np.full(2, 0.5))
    assert common.std == pytest.approx(0.1 * math.sqrt(0.25 + 0.5))


@pytest.mark.parametrize("common", [0.0, 0.5, 0.9])
def test_what_is_common_to_all_does_not_hide_that_they_differ(common):
    """Chi-square of the whole deviations was below .05 in 5, .2 and 0 % of these."""
    rng = np.random.default_rng(0)
    chances = []
    for _ in range(1000):
        own = math.sqrt(1 - common) * rng.normal(size=4)
        value = 10 + math.sqrt(common) * rng.normal() + own
        _, found = weighted_mean([Estimate(float(one), 1.0) for one in value], np.full(4, common))
        chances.append(_chance(found, 3))
    assert np.mean(np.array(chances) < 0.05) == pytest.approx(0.05, abs=0.02)
    assert np.mean(chances) == pytest.approx(0.5, abs=0.03)


def test_edges_that_agree_agree_in_every_number():
    """Of numbers without a budget the part that is common to all is not known."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.9), ac.optics.Detector()])
    chances = {name: [] for name in ("mtf50_cpp", "mtf30_cpp", "half_extent_bright_px", "rer")}
    for seed in range(16):
        board = ac.simulate.checkerboard(
            sensor, snr=22, tile_px=36, shape=(150, 150), rng=np.random.default_rng(seed)
        )
        for group in ac.measure_edges(board.image).groups.values():
            for name, found in chances.items():
                found.append(group.p_value[name])
    for found in chances.values():
        assert np.mean(np.array(found) < 0.05) < 0.13


def test_numbers_with_nothing_of_their_own_cannot_disagree():
    mean, found = weighted_mean([Estimate(1.0, 0.1), Estimate(1.3, 0.1)], np.ones(2))
    assert math.isnan(found)
    assert mean.std == pytest.approx(0.1)


def test_numbers_at_zero_are_not_averaged_as_if_gaussian():
    clipped = [Estimate(0.0, 0.017), Estimate(0.0, 0.015), Estimate(0.0, 0.017), Estimate(0, 0.011)]
    mean, chi_square = weighted_mean(clipped, np.zeros(4))
    assert mean.value == 0.0
    assert 0.011 < mean.std < 0.017
    assert math.isnan(chi_square)
    # Two overshoots that are not there, with next to no deviation, and one that is.
    mean, chi_square = weighted_mean(
        [Estimate(0, 0.0007), Estimate(0, 0.0009), Estimate(0.042, 0.012)], np.zeros(3)
    )
    assert mean.value == pytest.approx(0.014)
    assert mean.std == pytest.approx(0.014)
    assert math.isnan(chi_square)
    alone, _ = weighted_mean([Estimate(0.0, 0.017)], np.zeros(1))
    assert alone == Estimate(0.0, 0.017)


def test_a_blur_without_nyquist_has_no_chi_square_in_any_face():
    wide = ac.Sensor([ac.optics.Gaussian(1.1), ac.optics.Detector(1.0)])
    edges = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        image, _ = ac.simulate.edge(wide, angle_deg=8, snr=60, rng=rng, shape=(48, 48))
        edges.append(ac.measure_edge(image))
    assert min(m.mtf_nyquist.value / m.mtf_nyquist.std for m in edges) < 1
    (group,) = combine_edges(edges).values()
    assert math.isnan(group.chi_square["mtf_nyquist"])
    assert math.isnan(group.p_value["mtf_nyquist"])
    assert group.metrics["mtf_nyquist"].std >= min(m.mtf_nyquist.std for m in edges)
    assert group.p_value["rer"] > 1e-3
    result = TargetResult(tuple(edges), (), {group.orientation: group})
    (row,) = group_rows(result, ("mtf_nyquist",))
    assert row[3:] == ("–", "–")
    document = json.loads(json_text(document_of(result)))
    (written,) = document["groups"].values()
    assert written["chi_square"]["mtf_nyquist"] is None
    assert written["p_value"]["mtf_nyquist"] is None


def test_means_are_of_the_edges_of_the_best_verdict(edge_seen_by):
    good, other = (edge_seen_by(SYSTEM, seed) for seed in range(2))
    strip = edge_seen_by(SYSTEM, 2, edit=lambda image: np.minimum(image, 600.0))
    assert (good.verdict.word, strip.verdict.word) == ("good", "invalid")
    (group,) = combine_edges([good, strip, other]).values()
    assert (group.measurements, group.left_out) == ((good, other), (strip,))
    (without,) = combine_edges([good, other]).values()
    assert group.metrics == without.metrics
    result = TargetResult((good, strip, other), (), {group.orientation: group})
    assert "Left out of the means across: 2 (invalid)." in ac.report.text(result)
    document = json.loads(json_text(document_of(result)))
    (written,) = document["groups"].values()
    assert (written["edges"], written["left_out"]) == ([0, 2], [1])
    (alone,) = combine_edges([strip]).values()
    assert (alone.measurements, alone.left_out) == ((strip,), ())


def test_edges_that_disagree_are_said_to(edge_seen_by):
    soft = ac.Sensor([ac.optics.Detector(), ac.optics.Gaussian(0.9)])
    edges = (edge_seen_by(SYSTEM, 0), edge_seen_by(soft, 1))
    groups = combine_edges(edges)
    assert groups["across"].disagrees
    said = ac.report.text(TargetResult(edges, (), groups))
    assert "The edges across differ by more than their standard deviations explain" in said


def test_a_scene_may_declare_that_along_track_is_the_x_axis(scene):
    as_taken = ac.measure_edges(scene.image)
    turned = ac.measure_edges(ac.Image.from_array(scene.image, along_track="x"))
    for name, other in (("across", "along"), ("along", "across")):
        mean, same = as_taken.groups[name].metrics["rer"], turned.groups[other].metrics["rer"]
        assert same == mean
        assert {m.orientation for m in turned.groups[other].measurements} == {other}
        assert turned.groups[other].measurements[0].to_dict()["line"]["orientation"] == other
    with pytest.raises(ac.OptionError, match="along_track is 'z'"):
        ac.Image.from_array(scene.image, along_track="z")


def test_every_rejected_edge_is_told_in_pixels_of_the_whole_image(scene):
    canvas = np.full((500, 700), 500.0) + np.random.default_rng(5).normal(0, 5, (500, 700))
    rows, cols = scene.image.shape
    canvas[300 : 300 + rows, 400 : 400 + cols] = scene.image
    canvas[290:430, 530:] += 700.0
    roi = (290, 390, rows + 20, cols + 40)
    rejected = ac.measure_edges(canvas, roi).rejected
    assert {one.stage for one in rejected} == {"fit", "contrast"}
    for one in rejected:
        assert roi[0] <= one.values["row"] < roi[0] + roi[2]
        assert roi[1] <= one.values["col"] < roi[1] + roi[3]


def test_a_line_that_runs_on_to_another_object_shares_its_border():
    """Of a line over ten rows, the last three are the border of an edge that was measured."""

    def edge(rows):
        used = np.zeros((20, 20), bool)
        used[rows] = True
        details = SimpleNamespace(used=used, distance_px=columns[used])
        return _border(SimpleNamespace(details=details))

    columns = np.tile(np.arange(20.0) - 9.5, (20, 1))
    long, short = edge(slice(0, 10)), edge(slice(7, 15))
    assert _shared(long, short) == pytest.approx(0.3)
    assert _shared(short, long) == pytest.approx(3 / 8)
    assert _shared(long, edge(slice(10, 15))) == 0.0
