"""Figures: what they show, and that nothing is written over anything else."""

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from matplotlib.axis import Axis, Tick
from matplotlib.text import Text

from acutance import optics, simulate
from acutance.report import compare, draw, figure_bytes, panels, save_figure
from acutance.report.figures.campaign import campaign_figure
from acutance.report.figures.pixels import show_pixels
from acutance.report.paper import new_page, styled
from acutance.report.tables.campaign import CampaignEntry
from acutance.targets import Check, TargetResult
from acutance.targets.straight import measure_pulse
from acutance.targets.straight.many_edges import combine_edges


def panel_figures(measurement):
    """Every drawing of an edge or a pulse on a page of its own."""
    names = ("mtf", "lsf", "target", "samples")
    figures = {}
    for name, panel in zip(names, panels(measurement), strict=True):
        with styled():
            figures[name] = new_page(6.0, panel.height_in)
            panel.draw(figures[name])
    return figures


@cache
def written(figure):
    """Every text that is drawn, with its box in pixels."""
    # Places of words are asked, not pixels.
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    hidden = {text for axis in figure.findobj(Axis) for text in _labels_out_of_view(axis)}
    return [
        (text.get_text(), text.get_window_extent(renderer))
        for text in figure.findobj(Text)
        if text.get_visible() and text.get_text().strip() and text not in hidden
    ]


def _labels_out_of_view(axis):
    """Labels of ticks that matplotlib keeps but does not draw."""
    low, high = sorted(axis.get_view_interval())
    margin = 1e-6 * (high - low)
    current = axis.get_major_ticks()
    for tick in {*axis.findobj(Tick), *current}:
        drawn = axis.axes.axison and tick in current
        if not drawn or not low - margin <= tick.get_loc() <= high + margin:
            yield from (tick.label1, tick.label2)


def overlaps(figure):
    pairs = combinations(written(figure), 2)
    return [
        (one, other)
        for (one, a), (other, b) in pairs
        if a.x0 < b.x1 - 1 and b.x0 < a.x1 - 1 and a.y0 < b.y1 - 1 and b.y0 < a.y1 - 1
    ]


def outside(figure):
    width, height = figure.canvas.get_width_height()
    return [
        text
        for text, box in written(figure)
        if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1
    ]


def texts(figure):
    return "\n".join(text for text, _ in written(figure))


def test_the_figure_of_an_edge_shows_every_step(measurement):
    figure = draw(measurement)
    shown = texts(figure)
    for title in (
        "Target",
        "Edge spread function",
        "Line spread function",
        "Modulation transfer function",
        "Numbers",
        "Checks: doubtful",
        "frequency [cycles/m]",
        "across, FWHM\n1.2084",
        "Nyquist",
        "aliased",
        "✗",
        "0.2890 ± 0.0039",
    ):
        assert title in shown, title


def test_what_leaves_the_drawing_of_a_campaign_is_an_arrow(make_edge, truth):
    def entry(target, reference, **blur):
        response = make_edge(**blur).response
        return CampaignEntry(target, "any", "across", response, truth, reference)

    entries = [
        entry("in", True, scatter=0.004),
        entry("interval out", False, scatter=0.02),
        entry("out", False, sigma_px=0.6),
    ]
    axes = campaign_figure(entries).axes[0]
    reach = axes.get_xlim()[1]
    arrows = [(line.get_ydata()[0], line.get_marker()) for line in axes.lines
              if line.get_marker() in ("<", ">")]  # fmt: skip
    assert sorted(arrows) == [(1.0, "<"), (1.0, ">"), (2.0, "<")]
    assert reach < 0.02


def test_the_figure_of_a_pulse_shows_both_sides_the_width_and_the_zeros(pulse):
    shown = texts(draw(pulse))
    for title in (
        "Pulse, method spline",
        "Pulse, w = 3.1530 ± 0.0050 px",
        "into the pulse",
        "fitted PRF",
        "1/w",
        "3/w",
        "Width on the ground",
        "All 18 checks passed.",
    ):
        assert title in shown, title
    assert "dark → bright" not in shown
    assert [one.is_target for one in panels(pulse)] == [False, False, True, False]


def test_the_drawn_response_is_the_fitted_one(pulse):
    axes = panel_figures(pulse)["samples"].axes[0]
    (line,) = [each for each in axes.lines if each.get_label() == "fitted PRF"]
    assert np.all(np.diff(line.get_xdata()) >= 0)
    middle = np.abs(line.get_xdata() - 0.5 * 3.153) < 0.2
    assert line.get_ydata()[middle] == pytest.approx(1.0, abs=0.02)
    assert line.get_ydata()[np.abs(line.get_xdata() - 6.0) < 1] == pytest.approx(0.0, abs=0.02)


def test_no_curve_passes_the_names_of_the_zeros():
    sensor = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])
    image, _ = simulate.pulse(sensor, snr=70.0, rng=np.random.default_rng(1))
    both = [measure_pulse(image, width_px=3.0, method=name) for name in ("spline", "sdsu-2005")]
    figure = draw(both)
    figure.draw_without_rendering()
    axes, renderer = figure.axes[0], figure.canvas.get_renderer()
    named = [one for one in axes.texts if one.get_text().endswith("/w")]
    assert [one.get_text() for one in named] == ["1/w", "2/w"]
    for box in (one.get_window_extent(renderer) for one in named):
        for line in axes.lines:
            points = axes.transData.transform(line.get_xydata())
            if np.ptp(points[:, 0]) > 0:
                x = np.linspace(box.x0, box.x1, 20)
                y = np.interp(x, *points.T)
                assert not np.any((y > box.y0) & (y < box.y1))


def test_the_zeros_are_at_the_multiples_of_one_over_the_width(make_pulse):
    axes = panel_figures(make_pulse(4.0))["mtf"].axes[0]
    dotted = [line.get_xdata()[0] for line in axes.lines if line.get_linestyle() == ":"]
    assert dotted == pytest.approx([0.25, 0.5, 0.75])


@pytest.mark.parametrize("width_px", [1.2, 2.0, 3.0, 6.0, 7.9, 20.0])
def test_pulses_of_every_width_keep_their_labels_apart(make_pulse, width_px):
    figures = panel_figures(make_pulse(width_px))
    for figure in (figures["mtf"], figures["samples"]):
        assert not overlaps(figure)
        assert not outside(figure)


def test_pulses_are_compared_with_the_true_width(pulse, make_pulse, truth):
    held = make_pulse(3.1, 0.0, "sdsu-2005")
    figure = draw(compare([pulse, held], truth=truth, true_width_px=3.15))
    shown = texts(figure)
    for number in ("Width [px]", "3.1500", "3.1530 ± 0.0050", "3.1000"):
        assert number in shown, number
    assert not overlaps(figure)
    assert not outside(figure)


def test_spikes_at_the_zeros_do_not_flatten_the_curves(pulse, truth):
    spiky = pulse.mtf.otf.copy()
    spiky[32] = 10.0
    ratio = replace(
        pulse,
        method="sdsu-2005",
        transfer=replace(pulse.response, mtf=replace(pulse.mtf, otf=spiky)),
    )
    assert panel_figures(ratio)["mtf"].axes[0].get_ylim()[1] < 1.5
    mtfs, differences = draw(compare([pulse, ratio], truth=truth)).axes[:2]
    assert mtfs.get_ylim()[1] < 1.5
    assert max(np.abs(differences.get_ylim())) <= 0.2


def test_nothing_overlaps_and_nothing_leaves_the_page(measurement, compared, truth, target):
    figures = {
        "edge": draw(measurement),
        "comparison": draw(compare(compared, truth=truth)),
        "target": draw(target),
        **panel_figures(measurement),
    }
    for name, figure in figures.items():
        assert not overlaps(figure), name
        assert not outside(figure), name


def test_a_long_path_is_shortened_in_the_titles(make_edge, compared):
    path = "/".join(["W" * 29] * 5) + "/scene.tif"
    long = make_edge(path=path)
    others = [replace(one, image=long.image) for one in compared]
    for figure in (draw(long), draw(others)):
        assert not outside(figure)
        assert "/scene.tif, band 1" in texts(figure)
        assert path not in texts(figure)


def test_without_details_curves_and_numbers_are_drawn(measurement, pulse, compared, target):
    for one in (measurement, pulse):
        light = one.without_details()
        assert len(panels(light)) == 2
        assert "Target" not in texts(draw(light))
        assert not overlaps(draw(light))
    light = [one.without_details() for one in compared]
    assert "Target" not in texts(draw(light))
    edges = tuple(one.without_details() for one in target.measurements)
    assert "4 edges measured" in texts(draw(TargetResult(edges, (), combine_edges(edges))))


def test_the_check_for_overlaps_sees_one(measurement):
    figure = panel_figures(measurement)["lsf"]
    axes = figure.axes[0]
    axes.text(0.9, 0.94, "on top of the FWHM", transform=axes.transAxes, ha="right", va="top")
    assert overlaps(figure)


def test_a_measurement_without_gsd_path_and_checks_is_drawn(vague_measurement):
    figure = draw(vague_measurement)
    shown = texts(figure)
    assert "cycles/m]" not in shown
    assert "No checks were made." in shown
    assert "undefined" in shown
    assert not overlaps(figure)


@pytest.mark.parametrize("normal_deg", [-174.0, 96.0, -84.0, 45.0])
def test_the_arrow_points_from_dark_to_bright(measurement, normal_deg):
    turned = replace(measurement, line=replace(measurement.line, normal_deg=normal_deg))
    axes = panel_figures(turned)["target"].axes[0]
    (arrow,) = [text for text in axes.texts if text.arrow_patch is not None]
    (col, row), (from_col, from_row) = arrow.xy, arrow.get_position()
    assert turned.line.normal_distance(row, col) > 0
    assert turned.line.normal_distance(from_row, from_col) < 0


@pytest.mark.parametrize("roi", [(1000, 2000, 150, 30), (1000, 20000, 20, 90)])
def test_long_and_flat_cuts_keep_their_labels_apart(make_edge, roi):
    normal_deg = 6.0 if roi[2] > roi[3] else -84.0
    figure = draw(make_edge(roi=roi, normal_deg=normal_deg, scatter=0.03))
    assert not overlaps(figure)
    assert not outside(figure)


def test_only_the_surroundings_of_the_pixels_used_are_drawn(measurement):
    used = np.zeros_like(measurement.details.used)
    used[10:30, 12:20] = True
    small = replace(measurement, details=replace(measurement.details, used=used))
    axes = panel_figures(small)["target"].axes[0]
    row, col = measurement.image.roi[:2]
    assert axes.get_ylim() == pytest.approx((row + 35.5, row + 3.5), abs=0.6)
    assert axes.get_xlim() == pytest.approx((col + 5.5, col + 25.5), abs=0.6)


def test_thirteen_checks_and_a_long_verdict_have_room(make_edge):
    checks = tuple(
        Check(f"uniformity_of_{i:02d}", 12.25 * i, ">=", 50.0, i % 2 == 0, "no") for i in range(13)
    )
    figure = draw(make_edge(checks=checks))
    assert not overlaps(figure)
    assert not outside(figure)


def test_a_comparison_without_truth_takes_the_first_as_reference(compared, truth):
    assert "MTF − spline" in texts(draw(compared))
    assert "MTF − truth" in texts(draw(compare(compared, truth=truth)))
    assert "1 spline" in texts(draw([compared[0], compared[0]]))


def test_a_target_without_edges_along_says_so(target, measurement):
    across = target.groups["across"]
    alone = TargetResult(across.measurements, (), {"across": across})
    figure = draw(alone, backdrop=measurement.details.pixels, origin=(5, 7))
    assert "0 rejected; none along" in texts(figure)
    assert "2 edges measured, 0 rejected" in texts(figure)


@pytest.mark.parametrize(
    ("ending", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_figures_are_saved_by_their_ending(measurement, tmp_path, ending, magic):
    path = tmp_path / f"lsf.{ending}"
    save_figure(panel_figures(measurement)["lsf"], path)
    assert path.read_bytes().startswith(magic)


def test_the_same_measurement_gives_the_same_bytes(measurement):
    first, second = (figure_bytes(panel_figures(measurement)["mtf"], ".svg") for _ in range(2))
    assert first == second


def test_a_dollar_sign_in_a_path_is_a_dollar_sign(measurement):
    odd = replace(measurement, image=replace(measurement.image, path="a$\\frac{$.tif"))
    assert "a$\\frac{$.tif" in texts(draw(odd))


def test_the_truth_of_a_pulse_knows_the_width_of_its_response():
    sensor = simulate.reference_systems()["halo"]
    rng = np.random.default_rng(0)
    image, truth = simulate.pulse(sensor, width_px=3.1, angle_deg=6, snr=80, rng=rng)
    pulse = measure_pulse(image, width_px=3.1)
    known = compare([pulse], truth=truth.response, true_width_px=truth.width_px).true_numbers
    assert known["prf_fwhm_px"].value == pytest.approx(truth.prf_fwhm_px, abs=1e-3)
    assert known["prf_fwhm_px"].std == 0
    assert "prf_fwhm_m" not in known


@pytest.mark.parametrize("shape", [(12, 187), (300, 8)])
def test_a_narrow_image_has_ticks_on_both_sides(shape):
    """Sides a twelfth as long as the other would have no interval between ticks at all."""
    figure = new_page(6.0, 4.0)
    axes = figure.subplots()
    show_pixels(axes, np.arange(shape[0] * shape[1], dtype=float).reshape(shape), 226, 507)
    assert figure_bytes(figure, ".png").startswith(b"\x89PNG")
    assert min(len(axes.get_xticks()), len(axes.get_yticks())) >= 2
