"""Bars measured against the truth of their simulation, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from periodic_scenes import (
    FREQ,
    STATED_BARS,
    bars_scene,
    errors_of,
    measured_bars,
    stated_groups,
)

import acutance as ac
from acutance.errors import NoBarsError, OptionError
from acutance.geometry.bar_group import Bars
from acutance.raster import Gsd, Image
from acutance.report import draw
from acutance.report.tables.bars import bars_tables
from acutance.simulate import reference_systems
from acutance.targets.periodic import BarsOptions, measure_bars
from acutance.targets.periodic.bars_find import find_bars
from acutance.targets.periodic.bars_readings import coltman_mtf


def _errors(found, truth):
    return errors_of(found.normal_response.mtf, [truth.response.mtf(f).value for f in FREQ])


def _names(checks):
    return [check.name for check in checks]


@pytest.mark.parametrize("name", ["gaussian", "sharpened", "smeared"])
def test_curve_along_the_normal(name):
    found, truth = measured_bars(name)
    error, std = _errors(found, truth)
    assert np.sqrt(np.mean(error**2)) < 0.005
    assert np.max(np.abs(error / std)) < 4.0
    assert np.all(std < 0.01)
    assert found.trusted
    assert found.directions_deg[0] == pytest.approx(6.0, abs=0.1)


def test_contrast_is_fitted_without_levels():
    image, truth = bars_scene(periods_px=(12, 5, 3.2, 2.2))
    found = measure_bars(image)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert abs(found.contrast.value - 1000) < 4 * found.contrast.std < 40


def test_groups_one_by_one():
    found, truth = measured_bars(stated=False)
    for one, group, true in zip(found.groups, truth.groups, truth.mtf, strict=True):
        assert one.period_px.value == pytest.approx(group.period_px, abs=0.01)
        assert one.bars.count == group.count
        assert abs(one.mtf.value - true) < 4 * one.mtf.std
        # A finite group does not show one frequency: the plain reading is near, not exact.
        assert one.reading.modulation == pytest.approx(true, abs=0.02)


def test_bars_beyond_nyquist_are_measured():
    image, truth = bars_scene(periods_px=(8, 4, 1.6, 1.3))
    found = measure_bars(image)
    assert [one.bars.count for one in found.groups] == [5, 5, 5, 5]
    beyond = found.groups[2]
    assert beyond.freq_cpp > 0.6
    assert abs(beyond.mtf.value - truth.mtf[2]) < 4 * beyond.mtf.std < 0.02


def test_aligned_bars_and_wide_bars():
    image, truth = bars_scene(
        angle_deg=0.0, periods_px=(16, 8, 5, 2.6), count=3, orientation="along"
    )
    found = measure_bars(image)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert [one.bars.count for one in found.groups] == [3, 3, 3, 3]
    # Measured along the columns, and not along the rows.
    assert found.along.mtf(0.4).std < 0.2 * found.across.mtf(0.4).std


def _both_directions(name):
    """Groups of both directions side by side, and the truth of either."""
    first, across = bars_scene(name, angle_deg=3.0)
    second, along = bars_scene(name, 2, angle_deg=3.0, orientation="along")
    height = max(first.shape[0], second.shape[0])
    image = np.full((height, first.shape[1] + second.shape[1]), 200.0)
    image += 10 * np.random.default_rng(3).standard_normal(image.shape)
    image[: first.shape[0], : first.shape[1]] = first
    image[: second.shape[0], first.shape[1] :] = second
    return image, {"across": across.response, "along": along.response}


def test_two_directions_keep_their_axes_phases_and_gsds():
    image, truths = _both_directions("trail")
    found = measure_bars(Image.from_array(image, gsd_m=Gsd(0.4, 0.7)))
    assert found.measured_directions == ("across", "along")
    # The system differs between the axes by more than what is allowed for.
    assert truths["across"].mtf_nyquist.value - truths["along"].mtf_nyquist.value > 0.05
    for name, truth in truths.items():
        response = found.directions[name]
        assert response.mtf_nyquist.value == pytest.approx(truth.mtf_nyquist.value, abs=0.03)
        assert truth.mtf.otf[35].imag == pytest.approx(response.mtf.otf[35].imag, abs=0.02)
    # A trail towards higher columns has a positive phase.
    assert found.across.mtf.otf[35].imag > 0.05
    for name, gsd_m in (("across", 0.7), ("along", 0.4)):
        response = found.directions[name]
        assert response.gsd_m == pytest.approx(gsd_m)
        assert response.fwhm_m.value == pytest.approx(gsd_m * response.fwhm_px.value)
    # An image that was flown over along its rows shows the same with the axes exchanged.
    bars = [group.bars for group in found.groups]
    exchanged = BarsOptions(
        tuple(
            Bars(b.col, b.row, 90 - b.normal_deg, b.period_px, b.count, b.length_px) for b in bars
        )
    )
    turned = measure_bars(
        Image.from_array(image.T, gsd_m=Gsd(0.7, 0.4), along_track="x"), options=exchanged
    )
    assert turned.image.along_track == "x"
    for name in truths:
        one, other = found.directions[name], turned.directions[name]
        assert one.mtf_nyquist.value == pytest.approx(other.mtf_nyquist.value, abs=2e-3)
        assert one.fwhm_m.value == pytest.approx(other.fwhm_m.value, rel=5e-3)


def test_the_direction_along_the_bars_is_not_measured():
    found, _ = measured_bars()
    assert found.measured_directions == ("across",)
    assert found.to_dict()["measured_directions"] == ["across"]
    assert found.record.measured_directions == ("across",)
    assert "along" not in found.summary()
    assert found.directions.keys() == {"across", "along"}
    image, _ = bars_scene(angle_deg=0.0, orientation="along")
    flown = measure_bars(Image.from_array(image, along_track="x"))
    assert flown.measured_directions == ("across",)


def test_dark_bars_gain_region_and_missing_pixels():
    image, truth = bars_scene()
    one, _ = measured_bars(stated=False)
    wide = np.full((image.shape[0] + 20, image.shape[1] + 30), 5000.0)
    wide[10:-10, 20:-10] = 4 * (1400 - image)
    dark = measure_bars(wide, (10, 20, *image.shape))
    assert dark.contrast.value < 0
    assert dark.normal_response.mtf_nyquist.value == pytest.approx(
        one.normal_response.mtf_nyquist.value, abs=1e-4
    )
    assert dark.groups[0].bars.row == pytest.approx(one.groups[0].bars.row + 10, abs=1e-3)
    image[20:24, 20:30] = math.nan
    error, std = _errors(measure_bars(image), truth)
    assert np.max(np.abs(error / std)) < 4.0


def test_deviations_are_those_of_the_errors():
    """Over eight systems: deviations 0.8 or 1.25 times as large lie outside."""
    squares, inside = [], []
    for number, name in enumerate(reference_systems()):
        error, std = _errors(*measured_bars(name, 20 + number))
        squares.append(np.mean((error / std) ** 2))
        inside.append(np.abs(error) < 1.96 * std)
    assert 0.8 < np.sqrt(np.mean(squares)) < 1.08
    assert np.mean(inside) > 0.9


def test_priors_are_as_wide_as_those_of_the_benchmark():
    """What the prior says shows where the bars say least: three times as much lies outside."""
    names = ("gaussian", "wide", "halo")
    free = [measured_bars(name, stated=False)[0] for name in names]
    relative = np.mean([one.contrast.std / one.contrast.value for one in free])
    assert relative == pytest.approx(0.0061, rel=0.08)
    stated = [measured_bars(name)[0] for name in names]
    curve = np.mean([one.normal_response.mtf(0.3).std for one in stated])
    assert curve == pytest.approx(0.0022, rel=0.08)


@pytest.mark.parametrize(("count", "wrong"), [(5, (3, 6)), (3, (5,))])
def test_a_wrong_number_of_bars_is_refused(count, wrong):
    image, _ = bars_scene("smeared", 1, count=count, periods_px=(14, 9, 5, 3), angle_deg=5.0)
    for stated in wrong:
        with pytest.raises(ac.NoBarsError, match=f"group of {count}, and {stated} were asked for"):
            ac.measure_bars(image, options=BarsOptions(count=stated))
    right = ac.measure_bars(image, options=BarsOptions(count=count))
    assert [one.bars.count for one in right.groups] == [count] * 4


@pytest.mark.parametrize(
    ("count", "periods", "angle_deg", "sign"),
    [
        (5, (20, 10, 5), 0.0, 1),
        (3, (42.5, 22.4, 11.8), -28.0, -1),
        (2, (33, 17, 9), 12.0, 1),
        (4, (29.3, 15.4, 8.1, 4.3), 38.0, -1),
    ],
)
def test_bars_wider_than_the_gaps_that_are_closed(count, periods, angle_deg, sign):
    """Each stands alone, and those in a row are a group."""
    image, truth = bars_scene(
        "diffraction", 1, count=count, periods_px=periods, angle_deg=angle_deg,
        length_px=3.0 * periods[0],
    )  # fmt: skip
    found, contrast = find_bars(sign * image)
    assert [one.count for one in found] == [count] * len(periods)
    assert [one.period_px for one in found] == pytest.approx(periods, rel=0.03)
    for one, true in zip(found, truth.groups, strict=True):
        assert abs(one.row - true.row) + abs(one.col - true.col) < 1.0
        assert one.length_px == pytest.approx(true.length_px, abs=1.5)
    assert np.sign(contrast) == sign


@pytest.mark.parametrize("count", [2, 3, 7])
@pytest.mark.parametrize("periods", [(12, 6, 2.5), (4, 3, 2.2)])
def test_groups_are_found_and_counted(count, periods):
    image, truth = bars_scene("smeared", count, count=count, periods_px=periods, angle_deg=-11.0)
    found, contrast = find_bars(image)
    assert contrast == pytest.approx(1000.0, rel=0.3)
    assert [one.count for one in found] == [count] * 3
    for one, group in zip(found, truth.groups, strict=True):
        assert math.hypot(one.row - group.row, one.col - group.col) < 2
        assert one.period_px == pytest.approx(group.period_px, rel=0.25 / count)


def test_nothing_that_is_not_bars():
    rng = np.random.default_rng(0)
    system = reference_systems()["gaussian"]
    with pytest.raises(NoBarsError, match="uniform"):
        measure_bars(np.full((60, 60), 7.0))
    edge, _ = ac.simulate.edge(system, snr=100, rng=rng)
    star, _ = ac.simulate.star(system, snr=100, rng=rng)
    one_bar, _ = bars_scene(periods_px=(12,), count=1)
    for image in (rng.standard_normal((80, 80)), edge, star, one_bar):
        with pytest.raises(NoBarsError, match="no whole group"):
            measure_bars(image)


def test_a_cut_off_group_is_none():
    image, _ = bars_scene()
    groups, _ = find_bars(image[:, : image.shape[1] // 2 + 4])
    assert len(groups) < 3


def test_bars_on_a_level_of_a_million_contrasts_are_those_on_none():
    image, _ = bars_scene()
    low = (image - 200) / 1000
    plain, high = measure_bars(low), measure_bars(low + 1e6)
    assert high.across.mtf_nyquist.value == pytest.approx(plain.across.mtf_nyquist.value, abs=1e-5)
    assert high.across.mtf_nyquist.std == pytest.approx(plain.across.mtf_nyquist.std, rel=1e-2)
    assert high.verdict.word == plain.verdict.word


def test_stated_groups_that_are_elsewhere():
    image, truth = bars_scene()
    groups = stated_groups(truth)
    away = tuple(Bars(-50.0, -50.0, 6.0, 8.0, 5, 24.0) for _ in groups)
    with pytest.raises(NoBarsError, match="outside the region"):
        measure_bars(image, options=BarsOptions(away))
    slow = tuple(
        Bars(g.row, g.col, g.normal_deg, 1.3 * g.period_px, 5, g.length_px) for g in groups
    )
    with pytest.raises(NoBarsError, match=r"period of 10\.40 px"):
        measure_bars(image, options=BarsOptions(slow))
    few = tuple(Bars(g.row, g.col, g.normal_deg, g.period_px, 3, g.length_px) for g in groups)
    failed = {check.name for check in measure_bars(image, options=BarsOptions(few)).failed_checks}
    assert {"contrast_snr", "correlated_noise"} <= failed


def test_clipped_bars_and_wrong_levels_fail_by_name():
    image, truth = bars_scene()
    groups = stated_groups(truth)
    clipped = measure_bars(np.clip(image, 0, 1000), options=BarsOptions(groups))
    assert "saturation" in _names(clipped.failed_checks)
    wrong = BarsOptions(groups, dark=200.0, bright=900.0, level_std=1.0)
    assert "correlated_noise" in _names(measure_bars(image, options=wrong).failed_checks)


@pytest.mark.parametrize("contrast", [1.0, -1.0])
def test_levels_of_another_image_are_invalid(contrast):
    image, truth = bars_scene()
    image = image if contrast > 0 else 1400.0 - image
    for dark, bright in ((100.0, 800.0), (300.0, 1300.0), (0.0, 4095.0)):
        wrong = BarsOptions(stated_groups(truth), dark=dark, bright=bright)
        found = measure_bars(image, options=wrong)
        assert found.verdict.word == "invalid"
        assert "stated_levels" in _names(found.failed_checks)
    right = BarsOptions(stated_groups(truth), dark=200.0, bright=1200.0)
    assert measure_bars(image, options=right).trusted


def test_zero_noise():
    image, truth = bars_scene(snr=None)
    found = measure_bars(image)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error)) < 0.002
    assert np.all(np.abs(error) < 4 * std)
    assert found.trusted


def test_uniform_background_without_noise_is_not_clipped():
    image, _ = bars_scene(snr=None, periods_px=(8.0, 4.0, 2.0))
    assert "saturation" not in _names(measure_bars(image).failed_checks)


def test_spots_on_the_groups_are_bounded_and_the_fit_settles():
    image, truth = bars_scene()
    rows, cols = np.random.default_rng(9).integers(14, 40, (2, 12))
    image[rows, cols] += 900.0
    found = measure_bars(image, options=STATED_BARS)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert found.snr == pytest.approx(100.0, rel=0.1)


def test_noise_that_correlates_in_any_direction_widens_the_intervals():
    image, truth = bars_scene(snr=None)
    white = np.random.default_rng(4).standard_normal(image.shape)
    smooth = (white + 0.5 * np.roll(white, (1, -1), axis=(0, 1))) / math.hypot(1.0, 0.5)
    smooth = (smooth + 0.5 * np.roll(smooth, 1, axis=0)) / math.hypot(1.0, 0.5)
    options = BarsOptions(stated_groups(truth))
    one, other = (measure_bars(image + 10 * noise, options=options) for noise in (white, smooth))
    assert other.normal_response.mtf(0.4).std > 1.2 * one.normal_response.mtf(0.4).std
    assert "correlated_noise" in _names(other.failed_checks)
    assert "correlated_noise" not in _names(one.failed_checks)


def test_options_are_refused_by_name():
    with pytest.raises(OptionError, match="1 bars in a group"):
        BarsOptions(count=1)
    with pytest.raises(OptionError, match=r"period of 0\.5 px"):
        BarsOptions((Bars(5, 5, 0, 0.5, 4, 20),))
    with pytest.raises(OptionError, match="dark and bright, or neither"):
        BarsOptions(bright=3.0)
    with pytest.raises(OptionError, match="method"):
        measure_bars(np.zeros((40, 40)), method="eye")


def test_coltman_series_of_a_known_system():
    system = reference_systems()["gaussian"]
    freq = np.arange(1, 120) / 100
    odd = 2 * np.arange(30) + 1
    otf = system.otf(np.outer(freq, odd).ravel(), np.zeros(freq.size * 30)).reshape(-1, 30)
    ctf = 4 / math.pi * otf.real @ ((-1.0) ** np.arange(30) / odd)
    inverse = coltman_mtf(freq, ctf)
    assert np.max(np.abs(inverse - otf[:, 0].real)[9:]) < 0.005


@pytest.mark.parametrize("angle_deg", [0.0, 6.0])
def test_a_ctf_whose_third_harmonic_pixels_hide_is_undefined(angle_deg):
    """Of a period of 6 px along the grid it lies at Nyquist: pixels show one of its two phases."""
    system = reference_systems()["sharpened"]
    image, truth = ac.simulate.bars(
        system, angle_deg=angle_deg, periods_px=(9.0, 6.001, 3.5), snr=100,
        rng=np.random.default_rng(4),
    )  # fmt: skip
    group = measure_bars(image, options=BarsOptions(count=5)).groups[1]
    document = group.to_dict()
    if angle_deg == 0:
        assert np.isnan([group.reading.ctf, group.reading.ctf_std, group.coltman]).all()
        assert document["ctf"]["value"] is document["coltman_mtf"] is None
    else:
        assert abs(group.reading.ctf - truth.ctf[1]) < 0.03
        assert document["coltman_mtf"] == group.coltman
    assert abs(group.reading.modulation - group.mtf.value) < 0.03


def test_document():
    found, _ = measured_bars()
    document = found.to_dict()
    assert document["kind"] == "bars"
    assert len(document["groups"]) == 3
    assert document["groups"][0]["mtf"]["std"] > 0
    assert document["normal"]["mtf_nyquist"]["value"] == found.normal_response.mtf_nyquist.value


@pytest.mark.parametrize(("turn_deg", "tile_px"), [(5.0, 17.0), (10.0, 28.0), (14.0, 22.0)])
def test_a_checkerboard_is_no_bars(turn_deg, tile_px):
    board = ac.simulate.checkerboard(
        ac.simulate.reference_systems()["gaussian"], snr=100, tile_px=tile_px, turn_deg=turn_deg,
        rng=np.random.default_rng(1),
    )  # fmt: skip
    with pytest.raises(NoBarsError, match="another pattern: bars explain"):
        ac.measure_bars(board.image)


def test_a_normal_of_nearly_zero_has_no_sign():
    image, _ = bars_scene(angle_deg=0.0, periods_px=(12, 8, 5))
    found = ac.measure_bars(image)
    found = replace(found, directions_deg=(-0.004, 90.0))
    (table, _) = bars_tables(found)
    assert table.rows[0] == ("direction of the normal", "0.00°")
    titles = [axes.get_title(loc="left") for axes in draw(found).axes]
    assert "MTF along the normal, 0.0°" in titles


def test_a_count_for_the_search_is_refused_where_groups_are_stated():
    group = Bars(row=20.0, col=20.0, period_px=4.0, count=5, length_px=20.0, normal_deg=3.0)
    with pytest.raises(ac.OptionError, match="count=3 is for the search of groups"):
        BarsOptions(groups=(group,), count=3)
