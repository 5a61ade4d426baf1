"""Whatever a simulation is handed in wrongly is refused in words, by the argument's name."""

import math
import re
from datetime import datetime

import numpy as np
import pytest

from acutance.errors import AcutanceError, ModelError, OptionError
from acutance.geometry import Line
from acutance.optics import Detector, Gaussian, Sensor
from acutance.simulate import (
    BarGroup,
    Border,
    EdgeTarps,
    Galaxy,
    GroundNoise,
    Noise,
    PairGround,
    Patch,
    Placed,
    Regrid,
    SideStrip,
    SkyField,
    SoftCorners,
    Star,
    TiltedFocus,
    Waves,
    add_patches,
    add_star,
    alias_bands,
    brookings,
    checkerboard,
    mirror_columns,
    mirror_square,
    overflights,
    pair_ground,
    render_edge,
    render_parcels,
    render_patches,
    render_pulse,
    render_raster,
    render_site,
    render_strip,
    resample,
    sky,
    stamp,
    tarp_patches,
    tarp_region,
    tarp_rows,
    texture,
)
from acutance.simulate import edge as simulated_edge

SENSOR = Sensor([Gaussian(0.4), Detector()])
RNG = np.random.default_rng(1)
LINE = Line(9.0, 9.0, 3.0)
SHAPE = (20, 20)
PATCH = Patch(9.0, 9.0, 4.0, 4.0, 0.0, 10.0)
NOISE = GroundNoise(grains=(1, 2), subpixels=4)
PLATE = np.zeros((40, 40))
WRONG = ["x", None, {"a": 1}, ["a"], [math.nan, 1.0], 1j, list, object()]


def seen(sensor_on=lambda day: SENSOR, tarps=(), dates=(datetime(2026, 1, 1),), rng=RNG):
    return next(overflights(sensor_on, tarps, SHAPE, dates, noise_std=1.0, air_px=0.1, rng=rng))


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda x: GroundNoise(grains=x),
        lambda x: NOISE.std_seen_by(x),
        lambda x: NOISE.field(x, RNG),
        lambda x: NOISE.field(SHAPE, x),
        lambda x: NOISE.seen_by(x, SHAPE, RNG),
        lambda x: NOISE.seen_by(SENSOR, x, RNG),
        lambda x: BarGroup(x, 1.0, 0.0, 4.0, 3, 9.0),
        lambda x: BarGroup(1.0, 1.0, 0.0, x, 3, 9.0),
        lambda x: EdgeTarps(x, 60.0, 60.0, 6.0, 20.0, 100.0, 900.0) if x != "x" else seen(x),
        lambda x: Galaxy(x, 1.0, 10.0, 2.0),
        lambda x: Galaxy(1.0, 1.0, 10.0, 2.0, profile=x),
        lambda x: SkyField(snr=x),
        lambda x: SkyField(half_light_px=x),
        lambda x: Regrid(a=x),
        lambda x: Placed(star_levels=x),
        lambda x: Placed(bars_level=x),
        lambda x: Border(x, 1.0, 3.0, 10.0),
        lambda x: SideStrip(0, "rim", x, 2.0, 3.0),
        lambda x: SideStrip(0, x, 1.0, 2.0, 3.0),
        lambda x: SideStrip(x, "rim", 1.0, 2.0, 3.0),
        lambda x: SoftCorners(x, SHAPE, 0.5),
        lambda x: SoftCorners(SENSOR, SHAPE, 0.5).at(x, 1.0),
        lambda x: TiltedFocus(x, SHAPE, 0.5, 0.5),
        lambda x: Waves(x, ()),
        lambda x: Waves(100.0, x),
        lambda x: Star(1.0, 1.0, 40.0, wave=x),
        lambda x: simulated_edge(SENSOR, polarity=x),
        lambda x: sky(SENSOR, x if x is not None else 3, rng=RNG),
        lambda x: sky(SENSOR, noise=x if x is not None else 3, rng=RNG),
        lambda x: checkerboard(SENSOR, strips=x) if x != {} else None,
        lambda x: checkerboard(SENSOR, texture_grain_px=x),
        lambda x: brookings(SENSOR, RNG, turn_deg=x),
        lambda x: mirror_columns(x),
        lambda x: mirror_columns((1.0, 1.0), step=x),
        lambda x: mirror_columns((1.0, 1.0), count=x),
        lambda x: mirror_columns((1.0, 1.0), apart_px=x),
        lambda x: mirror_square(x),
        lambda x: mirror_square((1.0, 1.0), side=x),
        lambda x: mirror_square((1.0, 1.0), pitch_px=x),
        lambda x: seen(sensor_on=x if x is not list else 3),
        lambda x: seen(tarps=x),
        lambda x: seen(dates=x),
        lambda x: seen(rng=x),
        lambda x: render_edge(x, LINE, SHAPE, 1.0, 2.0),
        lambda x: render_edge(SENSOR, x, SHAPE, 1.0, 2.0),
        lambda x: render_edge(SENSOR, LINE, x, 1.0, 2.0),
        lambda x: render_edge(SENSOR, LINE, SHAPE, x, 2.0),
        lambda x: render_pulse(SENSOR, x, SHAPE, width_px=3.0, left=1.0, level=2.0, right=1.0),
        lambda x: render_pulse(SENSOR, LINE, SHAPE, width_px=x, left=1.0, level=2.0, right=1.0),
        lambda x: render_patches(x, [PATCH], SHAPE),
        lambda x: render_patches(SENSOR, x, SHAPE),
        lambda x: render_patches(SENSOR, [PATCH], x),
        lambda x: render_patches(SENSOR, [PATCH], SHAPE, margin_px=x),
        lambda x: render_raster(x, PLATE, 4),
        lambda x: render_raster(SENSOR, x, 4),
        lambda x: render_raster(SENSOR, PLATE, x),
        lambda x: render_raster(SENSOR, PLATE, 4, drawn=x),
        lambda x: render_strip(SENSOR, x, SHAPE),
        lambda x: render_site(SENSOR, x, SHAPE),
        lambda x: render_parcels(SENSOR, x, SHAPE),
        lambda x: render_parcels(SENSOR, [], SHAPE, subpixels=x),
        lambda x: resample(x, [5.0], [5.0]),
        lambda x: resample(PLATE, x if x is not None else "x", [5.0]),
        lambda x: resample(PLATE, [5.0], [5.0], a=x),
        lambda x: stamp(x, np.ones((3, 3)), 1, 1),
        lambda x: stamp(PLATE, x, 1, 1),
        lambda x: stamp(PLATE, np.ones((3, 3)), x, 1),
        lambda x: add_patches(x, SENSOR, [PATCH]),
        lambda x: add_patches(PLATE, x, [PATCH]),
        lambda x: add_patches(PLATE, SENSOR, x),
        lambda x: add_star(PLATE, SENSOR, x, mean=1.0, amplitude=1.0),
        lambda x: alias_bands(x),
        lambda x: tarp_patches(x, 1.0, 2.0),
        lambda x: tarp_region(x),
        lambda x: tarp_rows(x, 4),
        lambda x: tarp_rows((300, 300), x),
        lambda x: texture(x, SHAPE, 1.0, 1.5, RNG),
        lambda x: texture(SENSOR, x, 1.0, 1.5, RNG),
        lambda x: texture(SENSOR, SHAPE, x, 1.5, RNG),
        lambda x: texture(SENSOR, SHAPE, 1.0, 1.5, x),
        lambda x: pair_ground(x, 4, PairGround(), RNG),
        lambda x: pair_ground(SHAPE, 4, x, RNG),
        lambda x: Noise(read=1.0).added_to(x, RNG) if x != [math.nan, 1.0] else seen(x),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(call, wrong):
    with pytest.raises(AcutanceError, match=r"give|has to|choose|finite|pass numpy"):
        call(wrong)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: GroundNoise(grains="x"), OptionError, "grains has to be several times a whole"),
        (lambda: checkerboard(SENSOR, strips=[3]), OptionError, "number 1 of strips is 3: give"),
        (lambda: mirror_square("ab"), OptionError, "row of first is 'a', it has to be a number"),
        (lambda: mirror_square((1.0, math.nan)), ModelError, "the column of first is nan"),
        (lambda: mirror_square((1.0, 1.0), side=-1), OptionError, "side is -1, .* 1 or more"),
        (lambda: texture(SENSOR, SHAPE, 1.0, 0.1, RNG), ModelError, "grain_px is 0.1"),
        (lambda: render_edge(SENSOR, LINE, (10**6, 10**6), 1, 2), ModelError, "million pixels"),
    ],
)
def test_what_makes_no_sense_is_refused(call, error, message):
    with pytest.raises(error, match=re.compile(message, re.DOTALL)):
        call()


def test_scalars_of_numpy_are_numbers():
    places = mirror_square((np.float32(1.0), np.int64(2)), side=np.int64(2), pitch_px=np.float64(5))
    assert places.tolist() == [[1, 2], [1, 7], [6, 2], [6, 7]]
    drawn = GroundNoise(grains=tuple(np.arange(1, 3)), subpixels=np.int64(2)).field((4, 4), RNG)
    assert drawn.shape == (8, 8)
