"""Whatever a caller hands in wrongly is refused by acutance's own errors, which say what to do."""

from __future__ import annotations

import re

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Estimate
from acutance.targets.periodic import BarsOptions
from acutance.targets.straight import PulseOptions

IMAGE = np.random.default_rng(0).normal(100.0, 1.0, (40, 40))
IMAGE[:, 20:] += 100.0


@pytest.fixture(scope="module")
def edge():
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    image, _ = ac.simulate.edge(sensor, angle_deg=6, snr=100, rng=np.random.default_rng(1))
    return ac.measure_edge(image)


@pytest.mark.parametrize(
    ("measure", "error", "message"),
    [
        (lambda: ac.measure_edge(IMAGE, "0,0,20,20"), ac.RegionError, "parse_roi"),
        (lambda: ac.measure_edge(IMAGE, (0, 0, 20)), ac.RegionError, "3 numbers: give four"),
        (lambda: ac.measure_edge(IMAGE, 5), ac.RegionError, "roi is of type int"),
        (lambda: ac.measure_edge(IMAGE, "abcd"), ac.RegionError, "the text 'abcd'"),
        (lambda: ac.measure_edge(IMAGE, gsd_m=(1, 2)), ac.OptionError, r"gsd_m is \(1, 2\).*Gsd"),
        (lambda: ac.measure_edge(IMAGE, gsd_m="a"), ac.OptionError, "gsd_m is 'a'"),
        (lambda: ac.measure_edge(IMAGE, gsd_m=True), ac.OptionError, "gsd_m is True"),
        (lambda: ac.measure_points(IMAGE, positions="a"), ac.OptionError, "positions are 'a'"),
        (lambda: ac.measure_edge(IMAGE, gsd_m=-1), ac.OptionError, "positive number"),
        (lambda: ac.Gsd("a", 1.0), ac.OptionError, "'a' between rows is no number"),
        (lambda: ac.Image.from_array(IMAGE, gsd_m=[1]), ac.OptionError, "gsd_m is"),
        (lambda: ac.open_image(None), ac.ImageError, "a NoneType: give the name"),
        (lambda: ac.open_image(IMAGE), ac.ImageError, "an array is measured as it is"),
        (lambda: ac.measure_edge([[1.0, 2.0], [3.0]]), ac.ImageError, "rows of equal length"),
        (lambda: ac.measure_edges([IMAGE, IMAGE]), ac.ImageError, "holds 2 images"),
        (lambda: ac.measure_edges([IMAGE, IMAGE[2:]]), ac.ImageError, "holds 2 images.* of pairs"),
        (lambda: ac.scan_bands(IMAGE), ac.ImageError, "that of one band: .*scan_scene"),
        (
            lambda: ac.scan_bands(np.zeros((300, 300, 3))),
            ac.ImageError,
            r"\(300, 300, 3\).*moveaxis\(array, -1, 0\), or array\[..., band\]",
        ),
        (lambda: ac.measure_edge("file.tif"), ac.ImageError, "'file.tif'.*acutance.open_image"),
        (lambda: ac.measure_edge(None), ac.ImageError, "the image is None"),
        (lambda: ac.measure_edge(IMAGE, options={}), ac.OptionError, "type dict: give EdgeOptions"),
        (
            lambda: ac.measure_edge(IMAGE, options=PulseOptions()),
            ac.OptionError,
            "PulseOptions: give EdgeOptions",
        ),
        (
            lambda: ac.measure_edges(IMAGE, options=PulseOptions()),
            ac.OptionError,
            "PulseOptions: give EdgeOptions",
        ),
        (
            lambda: ac.measure_pulse(IMAGE, options=ac.EdgeOptions()),
            ac.OptionError,
            "EdgeOptions: give PulseOptions",
        ),
        (lambda: ac.measure_star(IMAGE, options=BarsOptions()), ac.OptionError, "StarOptions"),
        (lambda: ac.measure_bars(IMAGE, options={}), ac.OptionError, "give BarsOptions"),
        (
            lambda: ac.measure_biresolution(IMAGE, IMAGE, options={}),
            ac.OptionError,
            "give BiresolutionOptions",
        ),
        (
            lambda: ac.measure_biresolution(IMAGE[::2, ::2], IMAGE, roi="all"),
            ac.RegionError,
            "the text 'all'",
        ),
        (lambda: ac.measure_star(IMAGE, cycles="36"), ac.OptionError, "cycles is '36'"),
        (lambda: ac.measure_star(IMAGE, cycles=36.5), ac.OptionError, "cycles is 36.5"),
        (lambda: ac.measure_star(IMAGE, cycles=float("nan")), ac.OptionError, "cycles is nan"),
        (lambda: ac.combine({"schema": "x"}), ac.OptionError, "a single dict was given"),
        (lambda: ac.combine(5), ac.OptionError, "a single int was given"),
        (lambda: ac.combine([], options={}), ac.OptionError, "give CombineOptions"),
        (lambda: ac.combine([], gsd_m="a"), ac.OptionError, "nothing to combine|gsd_m is 'a'"),
        (lambda: ac.Sensor(["a"]), ac.ModelError, "block 1 is 'a', which has no OTF"),
        (lambda: ac.Sensor([ac.optics.Detector]), ac.ModelError, "block 1 is .* no OTF"),
        (lambda: ac.Sensor(ac.optics.Detector()), ac.ModelError, "give a list"),
        (lambda: ac.Sensor([ac.optics.Detector()], gsd_m="a"), ac.ModelError, "gsd_m is 'a'"),
        (lambda: Estimate(0.3, -0.1), ac.OptionError, "deviation of -0.1: .* not below 0"),
        (lambda: Estimate("a", 1), ac.OptionError, "an estimate of 'a'"),
        (lambda: Estimate(1, None), ac.OptionError, "deviation of None: give two numbers"),
        (lambda: Estimate(1.0, 0.1).interval(95), ac.OptionError, "between 0 and 1, such as 0.95"),
        (lambda: Estimate(1.0, 0.1).interval(1), ac.OptionError, "between 0 and 1"),
        (lambda: Estimate(1.0, 0.1).interval("a"), ac.OptionError, "between 0 and 1"),
        (lambda: Estimate(1.0, 0.1).interval(0), ac.OptionError, "level is 0: .* between 0 and 1"),
        (
            lambda: ac.measure_edge(IMAGE, {"type": "Polygon", "coordinates": []}),
            ac.RegionError,
            "roi is {'type': 'Polygon', .*}: give .*parse_roi",
        ),
        (
            lambda: ac.measure_edge(IMAGE, np.s_[0:20, 0:20]),
            ac.RegionError,
            r"\(slice\(0, 20, None\), .* holds slices: give \(row, column, height, width\)",
        ),
        (lambda: ac.measure_edge(IMAGE, method=["spline"]), ac.OptionError, "no edge method .'spl"),
        (lambda: ac.measure_pulse(IMAGE, method=["a"]), ac.OptionError, "no pulse method .'a'"),
        (lambda: ac.measure_star(IMAGE, method=["a"]), ac.OptionError, "no star method .'a'"),
        (lambda: ac.measure_bars(IMAGE, method=["a"]), ac.OptionError, "no bars method .'a'"),
        (lambda: ac.measure_points(IMAGE, method=["a"]), ac.OptionError, "no points method .'a'"),
        (
            lambda: ac.measure_biresolution(IMAGE[::2, ::2], IMAGE, method=["a"]),
            ac.OptionError,
            "no bi-resolution method .'a'",
        ),
        (lambda: ac.measure_edge(IMAGE, b"0,0,20,20"), ac.RegionError, "the text b'0,0,20,20'"),
        (lambda: ac.measure_pulse(IMAGE, width_px="3"), ac.OptionError, "width_px is '3': .*pixel"),
        (lambda: ac.measure_pulse(IMAGE, width_m="3"), ac.OptionError, "width_m is '3': .*metres"),
        (
            lambda: ac.measure_pulse(IMAGE, width_m=[3], gsd_m=1.0),
            ac.OptionError,
            r"width_m is \[3\]: give a number of metres",
        ),
    ],
)
def test_refused_by_name(measure, error, message):
    with pytest.raises(error, match=re.compile(message, re.DOTALL)):
        measure()


def test_a_single_measurement_is_no_list(edge):
    with pytest.raises(ac.OptionError, match="a single StraightMeasurement was given: give a list"):
        ac.combine(edge)


def test_a_requirement_is_a_text(edge):
    with pytest.raises(ac.OptionError, match="the requirement is 3, no text: write 'mtf_nyquist"):
        edge.conformity(3)


def test_curves_are_called_at_numbers(edge):
    for curve, name in (
        (edge.mtf, "freq_cpp"),
        (edge.lsf, "distance_px"),
        (edge.esf, "distance_px"),
    ):
        with pytest.raises(ac.OptionError, match="lies outside the curve"):
            curve(1e3)
        with pytest.raises(ac.OptionError, match=f"{name} is 'a', which is no number"):
            curve("a")
        assert curve(np.array(0.5)) == curve(0.5) == curve(np.float64(0.5))


def test_whole_numbers_may_be_floats_and_a_polygon_may_be_its_corners():
    pixels, _ = ac.simulate.edge(
        ac.simulate.reference_systems()["gaussian"], angle_deg=6, shape=(60, 60), snr=100,
        rng=np.random.default_rng(0),
    )  # fmt: skip
    assert ac.Box(20.0, 5, np.float64(30), 30) == ac.Box(20, 5, 30, 30)
    by_box = ac.measure_edge(pixels, (10.0, 10, 40, 40.0))
    assert by_box.image.roi == (10, 10, 40, 40)
    corners = [(9.5, 9.5), (9.5, 49.5), (49.5, 49.5), (49.5, 9.5)]
    for polygon in (np.array(corners), corners):
        assert ac.measure_edge(pixels, polygon).mtf_nyquist == by_box.mtf_nyquist
    assert len(ac.measure_edges(pixels, np.array(corners)).measurements) == 1
    assert len(ac.measure_edges(pixels, np.array([[10, 10, 40, 40]]))) == 1
    with pytest.raises(ac.RegionError, match=r"whole number, not 20\.5"):
        ac.measure_edge(pixels, (20.5, 5, 30, 30))
