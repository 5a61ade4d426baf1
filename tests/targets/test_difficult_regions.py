"""Regions that once ended in an exception which is not ours: each is measured or refused."""

from __future__ import annotations

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import acutance as ac
from acutance import optics, report, simulate
from acutance.curves import Mtf
from acutance.curves.grid import FREQ_CPP
from acutance.geometry.line import Line
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.targets.pair.gaussian_fit import _weights
from acutance.targets.pair.spectral_ratio import pair_spectra
from acutance.targets.pair.tile import TapAxis, TapGrid
from acutance.targets.periodic.bars_find import find_bars
from acutance.targets.points.fit import _growth
from acutance.targets.points.noise import PointNoise
from acutance.targets.steps import finished
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.edge_checks import _change_along
from acutance.targets.straight.find_edges import Segment
from acutance.targets.straight.first_fit import FirstFit
from acutance.targets.straight.fit_edge import fit_edge, spline_edge
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.published.kompsat import start_points
from acutance.targets.straight.solve import solve
from acutance.targets.straight.trim import trim

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])


def solved_edge():
    image, truth = simulate.edge(
        SENSOR, angle_deg=6.0, shape=(40, 40), snr=100, rng=np.random.default_rng(2)
    )
    pixels = EdgePixels(image, truth.line, truth.dark, truth.bright, 0.6, 10.0)
    first = FirstFit(truth.line, GaussianPixel(0.4, 1.0), truth.dark, 1000.0, 10.0)
    return pixels, finished(solve(pixels.pixels, first))


def changed(solved, **parts):
    """The same solution with another model of the line spread function."""

    class Changed(type(solved)):
        @property
        def model(self):
            return replace(solved.model, **parts)

    return Changed(**vars(solved))


def test_a_response_without_height_or_middle_is_no_edge():
    """Where the correction takes the first fit's height away, no curve can be normalised."""
    pixels, solved = solved_edge()
    model = solved.model
    assert spline_edge(pixels.pixels, solved).response.rer.std > 0
    lowered = model.spline - np.linspace(0, 0.97 * model.height, model.spline.size)
    with pytest.raises(ac.NoEdgeError, match="a line or a bump and no step"):
        spline_edge(pixels.pixels, changed(solved, spline=lowered))
    lifted = model.spline + 2.0 * model.height * (np.arange(model.spline.size) > 3)
    with pytest.raises(ac.NoEdgeError, match="does not pass half its height"):
        spline_edge(pixels.pixels, changed(solved, spline=lifted))


def test_a_modulus_below_the_normal_numbers_has_no_phase():
    otf = np.where(FREQ_CPP > 0.5, 1e-310 * (1 + 1j), 1.0)
    mtf = Mtf(FREQ_CPP, otf, np.ones((FREQ_CPP.size, 1)) * 1e-3 + 0j)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isfinite(mtf.std).all()
        assert mtf(0.75).value == pytest.approx(0.0, abs=1e-300)


def test_where_no_pixel_is_dark_the_growth_of_the_noise_stays_what_it_was():
    """Sources so close that no pixel shows the background alone."""
    state = SimpleNamespace(light=np.linspace(50.0, 100.0, 30), residual=np.ones(30))
    noise = PointNoise.white(30)
    grown = replace(noise, growth=0.3)
    assert _growth(None, None, None, grown, None, None, state.light, state) == 0.3


def test_a_star_whose_tables_would_fill_the_memory_is_refused():
    side = 720
    rows, cols = np.indices((side, side)) - 0.5 * side
    image = 100 + 50 * np.cos(36 * np.arctan2(rows, cols))
    image[np.hypot(rows, cols) > 345] = 100
    image += np.random.default_rng(0).normal(0, 1, image.shape)
    with pytest.raises(ac.NoStarError, match="at most 300 px are fitted"):
        ac.measure_star(image)


def test_an_image_of_many_blobs_is_no_bar_target():
    """600 x 600 pixels with 400 squares: refused before each is measured."""
    image = np.random.default_rng(0).normal(100, 1, (600, 600))
    for top in range(10, 590, 29):
        for left in range(10, 590, 29):
            image[top : top + 9, left : left + 9] += 100
    with pytest.raises(ac.NoBarsError, match="separate parts stand out"):
        find_bars(image)


def test_pixels_that_begin_far_from_the_line_are_no_plateau():
    """Beyond 40 px from the line nothing counts: rows that have no other pixels are not used."""
    image = np.random.default_rng(1).normal(0, 1, (60, 160))
    image[:, 80:] += 100
    image[:, 25:135] = np.nan
    image[:12, 60:100] = np.random.default_rng(2).normal(0, 1, (12, 40)) + 100 * (
        np.arange(40) >= 20
    )
    segment = Segment(Line(6.0, 79.5, 0.0, length_px=12.0), -6.0, 6.0, 100.0)
    _, extent = trim(image, segment)
    assert extent.length_px <= 13


def test_a_curve_that_is_steepest_at_its_end_has_no_start_points():
    x = np.linspace(-8, 8, 400)
    with pytest.raises(ac.NoEdgeError, match="at the end of the search"):
        start_points(x, np.exp(x), np.ones(x.size), -8.0, 8.0, 0.5)


def test_windows_displaced_by_more_than_their_size_have_no_spectra():
    axis = TapAxis(2, 0.0, 8)
    gaussian = SimpleNamespace(
        down=SimpleNamespace(shift_px=0.0), across=SimpleNamespace(shift_px=40.0)
    )
    assert pair_spectra([], [], TapGrid(axis, axis), gaussian, 16) is None


def test_weights_of_residuals_of_any_size():
    residual = np.array([1e-200, -1e-200, 2e-200, 1e100])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert _weights(residual, 0.0)[-1] < 1e-9


def test_pixels_next_to_no_part_of_an_edge_show_no_change_along_it():
    image, truth = simulate.edge(
        SENSOR, angle_deg=6.0, shape=(40, 40), snr=100, rng=np.random.default_rng(2)
    )
    pixels = EdgePixels(image, truth.line, truth.dark, truth.bright, 0.6, 10.0)
    data = CheckData.of(pixels, fit_edge(pixels))
    assert _change_along(data, np.zeros(int(np.count_nonzero(data.near)))) == 0.0


def test_a_target_of_which_no_edge_was_measured_has_words_but_no_page():
    found = ac.measure_edges(np.random.default_rng(0).normal(100, 1, (40, 40)))
    assert found.measurements == ()
    assert "0 edges measured" in report.text(found)
    assert report.document(found)["measurements"] == []
    for output in (report.page, report.draw):
        with pytest.raises(ac.OptionError, match="nothing to draw"):
            output(found)
