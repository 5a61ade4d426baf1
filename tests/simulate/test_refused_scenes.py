"""What cannot be rendered is refused in words, before memory is taken for it."""

import math
from datetime import datetime

import numpy as np
import pytest

from acutance.errors import ModelError, OptionError
from acutance.optics import Detector, presets
from acutance.simulate import (
    EdgeTarps,
    LandscapeOptions,
    Noise,
    Patch,
    Point,
    PulseTarp,
    SkyField,
    Star,
    Strip,
    add_star,
    bars,
    brookings,
    checkerboard,
    edge,
    landscape,
    overflights,
    pair,
    points,
    pulse,
    reference_systems,
    render_site,
    sky,
    star,
    tarp_rows,
)

STAR = Star(60.0, 60.0, 40.0)
SENSOR = reference_systems()["gaussian"]
HUGE = (1_000_000, 1_000_000)
RNG = np.random.default_rng(1)
NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    "render",
    [
        lambda: edge(SENSOR, shape=HUGE),
        lambda: pulse(SENSOR, shape=HUGE),
        lambda: star(SENSOR, shape=HUGE),
        lambda: bars(SENSOR, length_px=1e7),
        lambda: points(SENSOR, shape=HUGE),
        lambda: points(SENSOR, positions=[(1e9, 1e9)]),
        lambda: checkerboard(SENSOR, shape=HUGE),
        lambda: render_site(SENSOR, [], HUGE),
        lambda: pair(SENSOR, SENSOR, shape=HUGE, rng=np.random.default_rng(1)),
    ],
)
def test_an_image_beyond_memory_is_refused(render):
    with pytest.raises(ModelError, match=r"an image of \d+ by \d+ px .* million pixels"):
        render()


@pytest.mark.parametrize("shape", [(0, 40), (40, -1)])
def test_an_image_without_pixels_is_refused(shape):
    with pytest.raises(ModelError, match="1 or more"):
        edge(SENSOR, shape=shape)


def test_a_star_beyond_memory_is_refused():
    with pytest.raises(ModelError, match="60 million are possible: use a smaller radius"):
        star(SENSOR, shape=(4000, 4000), radius_px=1500.0)


@pytest.mark.parametrize("level", [NAN, INF, -INF])
@pytest.mark.parametrize("render", [edge, pulse, bars, star])
def test_levels_are_numbers(render, level):
    with pytest.raises(ModelError, match=r"bright is .*, it has to be a finite number"):
        render(SENSOR, bright=level)


@pytest.mark.parametrize("wrong", [NAN, INF])
@pytest.mark.parametrize(
    ("render", "named"),
    [
        (lambda x: points(SENSOR, positions=[(20, 20)], fluxes=[x]), "a flux is"),
        (lambda x: star(SENSOR, ground=x), "ground is"),
        (lambda x: star(SENSOR, centre=(x, 2.0)), "the row of centre is"),
        (lambda x: Star(x, 60.0, 40.0), "Star: row is"),
        (lambda x: add_star(np.zeros((9, 9)), SENSOR, STAR, mean=x, amplitude=1.0), "mean is"),
        (lambda x: checkerboard(SENSOR, centre=(60.0, x)), "the column of centre is"),
        (lambda x: render_site(SENSOR, [], (50, 50), ground=x), "ground is"),
        (lambda x: EdgeTarps("a", x, 60.0, 6.0, 20.0, 100.0, 900.0), "EdgeTarps: row is"),
        (lambda x: EdgeTarps("a", 60.0, 60.0, x, 20.0, 100.0, 900.0), "EdgeTarps: normal_deg is"),
        (lambda x: EdgeTarps("a", 60.0, 60.0, 6.0, 20.0, x, 900.0), "EdgeTarps: dark is"),
        (lambda x: PulseTarp("a", 60.0, 60.0, 6.0, 3.0, 50.0, x), "PulseTarp: level is"),
        (lambda x: Patch(x, 1.0, 5.0, 5.0, 0.0, 10.0), "Patch: row is"),
        (lambda x: Patch(1.0, 1.0, 5.0, 5.0, 0.0, x), "Patch: contrast is"),
        (lambda x: Strip(1.0, 1.0, x, 5.0, 10.0), "Strip: normal_deg is"),
        (lambda x: Point(1.0, 1.0, x), "Point: flux is"),
        (
            lambda x: next(
                overflights(
                    lambda when: SENSOR, [], (50, 50), [datetime(2026, 1, 1)],
                    noise_std=x, air_px=0.1, rng=np.random.default_rng(1),
                )
            ),
            "noise_std is",
        ),
    ],
)  # fmt: skip
def test_places_and_levels_of_scenes_are_finite(render, named, wrong):
    with pytest.raises(ModelError, match=rf"^{named} .*finite( number.*)?$"):
        render(wrong)


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"periods_px": (8.0, NAN)}, "finite and above 0"),
        ({"periods_px": (8.0, INF)}, "finite and above 0"),
        ({"length_px": INF}, "finite and above 0"),
        ({"count": 0}, "BarGroup: count is 0, it has to be a whole number from 1"),
        ({"count": "x"}, "BarGroup: count is 'x', it has to be a whole number"),
        ({"count": 2.5}, "BarGroup: count is 2.5, it has to be a whole number from 1"),
        ({"count": 100_000_000}, "BarGroup: count is 100000000"),
    ],
)
def test_bars_have_a_size(sizes, message):
    with pytest.raises(ModelError, match=message):
        bars(SENSOR, **sizes)


@pytest.mark.parametrize(
    ("light", "message"),
    [
        ({"peak": 0.0}, "a source adds light"),
        ({"peak": -3.0}, "a source adds light"),
        ({"peak": NAN}, "peak is nan"),
        ({"background": INF}, "background is inf"),
        ({"positions": [(NAN, 3.0)]}, "not a finite number"),
    ],
)
def test_sources_shine(light, message):
    with pytest.raises(ModelError, match=message):
        points(SENSOR, **light)


@pytest.mark.parametrize(
    "scene",
    [
        lambda texture: brookings(SENSOR, np.random.default_rng(1), texture_std=texture),
        lambda texture: checkerboard(SENSOR, texture_std=texture),
        lambda texture: render_site(SENSOR, [], (50, 50), texture_std=texture),
    ],
)
@pytest.mark.parametrize("texture", [-1.0, NAN, INF])
def test_texture_is_0_or_more(scene, texture):
    with pytest.raises(ModelError, match=r"texture_std( \(--texture\))? is"):
        scene(texture)


@pytest.mark.parametrize(("count", "turn"), [(0, 6.0), (-1, 6.0), (1, NAN), (1, 90.0)])
def test_rows_of_tarps_have_tarps(count, turn):
    with pytest.raises(ModelError, match="there has to be 1 or more, turned by -45 to 45"):
        tarp_rows((1000, 1000), count, turn_deg=turn)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"gain": 0.0}, "leaves no contrast"),
        ({"gain": NAN}, "gain is nan"),
        ({"offset": INF}, "offset is inf"),
        ({"dark": 5.0, "bright": 5.0}, "leaves no contrast"),
        ({"shift_px": (1e9, 0.0)}, "at most half of the image"),
        ({"shift_px": (0.0, -15.1)}, "at most half of the image"),
        ({"shift_px": (0.0, NAN)}, "the column of shift_px is nan"),
        ({"ratio": NAN}, "ratio is nan"),
        ({"ratio": INF}, "ratio is inf"),
    ],
)
def test_a_pair_shows_the_same_ground(change, message):
    with pytest.raises(ModelError, match=message):
        pair(SENSOR, SENSOR, shape=(40, 30), rng=np.random.default_rng(1), **change)


@pytest.mark.parametrize(
    ("render", "message"),
    [
        (lambda: edge(SENSOR, snr=100, rng=3), r"rng is 3: pass numpy.random.default_rng\(3\)"),
        (lambda: pulse(SENSOR, snr=100, rng="a"), r"rng is 'a': pass numpy.random.default_rng\(\)"),
        (lambda: pair(SENSOR, SENSOR, rng=3), "rng is 3"),
        (lambda: checkerboard(SENSOR, texture_std=5.0, rng=3), "rng is 3"),
        (lambda: brookings(SENSOR, 3), "rng is 3"),
        (lambda: edge(SENSOR, shape=60), r"shape is 60: it has to be two whole numbers"),
        (lambda: edge(SENSOR, shape=(60, 40, 3)), "two whole numbers"),
        (lambda: edge(SENSOR, shape=(60.5, 40)), "two whole numbers"),
        (lambda: star(SENSOR, shape="big"), "two whole numbers"),
        (lambda: checkerboard(SENSOR, shape=60), "two whole numbers"),
        (lambda: edge(SENSOR, dark="200"), "dark is '200', it has to be a number"),
        (lambda: edge(SENSOR, snr="100"), "snr is '100', it has to be a number"),
        (lambda: edge(SENSOR, angle_deg=None), "angle_deg is None, it has to be a number"),
        (lambda: edge(SENSOR, noise=3.0), r"noise is 3.0: give Noise\(...\)"),
        (lambda: edge(SENSOR, regrid=0.5), r"regrid is 0.5: give Regrid\(...\)"),
        (lambda: edge(SENSOR, ground_noise=0), r"ground_noise is 0: give GroundNoise\(...\)"),
        (lambda: pulse(SENSOR, noise="x"), r"noise is 'x': give Noise\(...\)"),
        (lambda: pulse(SENSOR, regrid="x"), r"regrid is 'x': give Regrid\(...\)"),
        (lambda: pulse(SENSOR, ground_noise="x"), "ground_noise is 'x': give GroundNoise"),
        (lambda: pulse(SENSOR, length_px={}), "length_px is {}, it has to be a number"),
        (lambda: points(SENSOR, positions="x"), "positions is 'x': it has to hold numbers"),
        (lambda: points(SENSOR, fluxes="x"), "fluxes is 'x': it has to hold numbers"),
        (lambda: points(SENSOR, noise=[1]), r"noise is \[1\]: give Noise"),
        (lambda: bars(SENSOR, periods_px=8), "periods_px is 8: it has to be a sequence"),
        (lambda: bars(SENSOR, periods_px="x"), "periods_px is 'x': it has to hold numbers"),
        (lambda: bars(SENSOR, length_px="x"), "length_px is 'x', it has to be a number"),
        (lambda: bars(SENSOR, angle_deg="x"), "angle_deg is 'x', it has to be a number"),
        (lambda: star(SENSOR, centre=3), "centre is 3: it has to be two numbers"),
        (lambda: star(SENSOR, ground="x"), "ground is 'x', it has to be a number"),
        (lambda: checkerboard(SENSOR, centre=3), "centre is 3: it has to be two numbers"),
        (lambda: checkerboard(SENSOR, noise="x"), "noise is 'x': give Noise"),
        (lambda: checkerboard(SENSOR, tile_px="x"), "tile_px is 'x', it has to be a number"),
        (lambda: render_site(SENSOR, [], (50, 50), noise="x"), "noise is 'x': give Noise"),
        (lambda: pair(SENSOR, SENSOR, shift_px=1, rng=RNG), "shift_px is 1: it has to be two"),
        (lambda: pair(SENSOR, SENSOR, ground=0, rng=RNG), "ground is 0: give PairGround"),
        (lambda: pair(SENSOR, SENSOR, native=1, rng=RNG), "native is 1: give NativeGrid"),
        (lambda: pair(SENSOR, SENSOR, noise_low=1, rng=RNG), "noise_low is 1: give Noise"),
        (lambda: landscape(SENSOR, options=3, rng=RNG), "options is 3: give LandscapeOptions"),
        (lambda: landscape(SENSOR, noise=3, rng=RNG), "noise is 3: give Noise"),
    ],
)
def test_arguments_of_the_wrong_kind_are_refused_by_name(render, message):
    with pytest.raises(OptionError, match=message):
        render()


@pytest.mark.parametrize(
    "render",
    [
        edge,
        pulse,
        star,
        bars,
        points,
        checkerboard,
        lambda sensor: brookings(sensor, np.random.default_rng(1)),
        lambda sensor: render_site(sensor, [], (50, 50)),
        lambda sensor: sky(sensor, rng=np.random.default_rng(1)),
        lambda sensor: landscape(sensor, shape=(150, 150), rng=np.random.default_rng(1)),
        lambda sensor: pair(sensor, SENSOR, rng=np.random.default_rng(1)),
        lambda sensor: pair(SENSOR, sensor, rng=np.random.default_rng(1)),
        lambda sensor: next(
            overflights(
                lambda when: sensor, [], (50, 50), [datetime(2026, 1, 1)],
                noise_std=1.0, air_px=0.1, rng=np.random.default_rng(1),
            )
        ),
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        ("ikonos-like", r"'ikonos-like': give a Sensor, .*optics\.preset\('ikonos-like'\)"),
        (presets()["ikonos-like"], r"SensorFile\(.*: give a Sensor, .*optics\.preset"),
        (Detector(), r"Detector\(.*: give a Sensor"),
        (None, r"sensor is None: give a Sensor, .*optics\.read_sensor\(path\)"),
    ],
)
def test_what_is_no_sensor_is_refused(render, sensor, message):
    with pytest.raises(OptionError, match=message):
        render(sensor)


@pytest.mark.parametrize(
    "described",
    [
        {"width_px": 200.0},
        {"shape": (1, 1)},
        {"offset_px": 25.0},
        {"width_px": 70.0, "orientation": "along"},
    ],
)
def test_an_image_without_the_sides_of_its_pulse_is_refused(described):
    with pytest.raises(ModelError, match=r"the sides of the pulse lie .* use a larger image"):
        pulse(SENSOR, **described)


def test_an_snr_goes_with_noise_that_leaves_the_strength_open():
    image, truth = edge(SENSOR, snr=100.0, noise=Noise(quantum=1.0), rng=np.random.default_rng(1))
    assert (truth.noise.read, truth.noise.quantum) == (10.0, 1.0)
    assert np.array_equal(image, np.round(image))
    with pytest.raises(ModelError, match="both set the white noise"):
        edge(SENSOR, snr=100.0, noise=Noise(read=3.0), rng=np.random.default_rng(1))
    with pytest.raises(ModelError, match="saturation is nan"):
        Noise(saturation=NAN)


@pytest.mark.parametrize(
    ("render", "described"),
    [
        (edge, {"dark": 200.0}),
        (pulse, {"dark": 300.0, "right_dark": 200.0}),
        (bars, {"dark": 200.0}),
        (bars, {"dark": 1200.0, "bright": 200.0}),
        (star, {"dark": 200.0}),
        (checkerboard, {"dark": 200.0, "bright": 900.0, "ground": 700.0}),
        (points, {"positions": [(12.0, 12.0)], "background": 200.0}),
    ],
)
def test_a_saturation_at_the_lowest_level_is_refused(render, described):
    with pytest.raises(ModelError, match="saturation is 200 and the lowest level 200"):
        render(SENSOR, noise=Noise(saturation=200.0), **described)
    render(SENSOR, noise=Noise(saturation=250.0), **described)


def test_shot_noise_of_negative_signal_is_refused():
    rng = np.random.default_rng(1)
    with pytest.raises(ModelError, match=r"shot_gain is 1 and the lowest level -200"):
        edge(SENSOR, dark=-200.0, bright=100.0, noise=Noise(shot_gain=1.0), rng=rng)
    edge(SENSOR, dark=-200.0, bright=100.0, noise=Noise(read=1.0), rng=rng)
    with pytest.raises(ModelError, match=r"shot_gain is 1 and the lowest level -100"):
        bars(SENSOR, dark=1000.0, bright=-100.0, noise=Noise(shot_gain=1.0), rng=rng)


@pytest.mark.parametrize(("make", "name"), [(SkyField, "snr"), (LandscapeOptions, "contrast")])
@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (3, "has to be two numbers, the lowest and the highest"),
        ((1.0,), "has to be two numbers, the lowest and the highest"),
        (("a", "b"), "has to be a number"),
        ((5.0, 1.0), "is 5 to 1, the lowest cannot be above the highest"),
        ((-1.0, 1.0), "has to be finite"),
        ((1.0, float("inf")), "has to be finite"),
    ],
)
def test_ranges_of_skies_and_landscapes_are_refused_in_the_same_words(make, name, wrong, words):
    with pytest.raises(ModelError, match=words):
        make(**{name: wrong})
