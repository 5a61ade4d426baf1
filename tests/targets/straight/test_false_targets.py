"""What is no target, or a spoiled one: a check says so, or it does no harm."""

import numpy as np
import pytest

import acutance as ac
from acutance import optics
from acutance.simulate import Regrid

SENSOR = ac.Sensor([optics.Gaussian(0.4), optics.Detector()])


def failed(measurement):
    return {check.name for check in measurement.failed_checks}


def edge(seed, **options):
    rng = np.random.default_rng(seed)
    image, truth = ac.simulate.edge(SENSOR, **{"angle_deg": 6, "snr": 100, "rng": rng, **options})
    return np.asarray(image), truth


def crossed(seed, angle_deg, bright):
    first, _ = edge(seed, shape=(60, 60))
    second, _ = ac.simulate.edge(SENSOR, angle_deg=angle_deg, dark=0, bright=bright, shape=(60, 60))
    return first + np.asarray(second)


@pytest.mark.parametrize("width_px", [1.0, 3.0])
def test_a_pulse_is_no_edge_and_says_so(width_px):
    pulse, _ = ac.simulate.pulse(
        SENSOR, width_px=width_px, angle_deg=6.0, shape=(60, 50), snr=100,
        rng=np.random.default_rng(1),
    )  # fmt: skip
    with pytest.raises(ac.NoEdgeError, match=r"a line or a pulse and no.* step.*acutance pulse"):
        ac.measure_edge(pulse)


def test_fill_inside_the_region_is_named_where_no_edge_is_found():
    image, _ = edge(1, shape=(60, 60))
    image[20:26, 25:31] = -9999
    with pytest.raises(ac.NoEdgeError, match="36 of the pixels are -9999, far from all others"):
        ac.measure_edge(image)


@pytest.mark.parametrize(("angle_deg", "bright"), [(-5, 200), (-5, 300), (-12, 300), (20, 200)])
@pytest.mark.parametrize("seed", range(3))
def test_a_second_edge_across_the_first_is_noticed(angle_deg, bright, seed):
    found = ac.measure_edge(crossed(seed, angle_deg, bright))
    assert failed(found) & {"blur_uniformity", "edge_roughness_px", "asymmetric_lsf"}


@pytest.mark.parametrize("system", ["gaussian", "diffraction", "sharpened", "halo", "asymmetric"])
def test_a_steady_edge_passes(system):
    sensor = ac.simulate.reference_systems()[system]
    for seed in range(8):
        rng = np.random.default_rng(seed)
        snr = float(rng.choice([40, 100, 1000]))
        angle = float(rng.uniform(3, 40))
        image, _ = ac.simulate.edge(sensor, angle_deg=angle, snr=snr, shape=(50, 50), rng=rng)
        checks = {check.name: check for check in ac.measure_edge(image).checks}
        for name in ("blur_uniformity", "edge_roughness_px", "lsf_width_px"):
            assert checks[name].passed, (seed, checks[name])


@pytest.mark.parametrize("offset", [300, 500, 900])
def test_numbers_that_wrapped_around_are_no_edge_of_light(offset):
    image, _ = edge(1)
    wrapped = (image.round().astype(int) - offset).astype("uint16")
    assert "lsf_width_px" in failed(ac.measure_edge(wrapped))


@pytest.mark.parametrize("step", [3, 5])
def test_an_image_decimated_without_averaging_is_sharper_than_any_pixel(step):
    image, _ = edge(7, shape=(240, 240))
    decimated = ac.measure_edge(image[::step, ::step])
    assert not decimated.trusted
    (check,) = (one for one in decimated.failed_checks if one.name == "full_pixel")
    found = decimated.mtf_nyquist
    assert check.value == pytest.approx(found.value - 2 * found.std)
    assert (
        f"is {found}, surely (by 2 standard deviations) above {check.value:.2f};" in check.message
    )


@pytest.mark.parametrize("angle_deg", [4, 20, 44])
def test_a_full_pixel_alone_is_not_sharper_than_one(angle_deg):
    sensor = ac.Sensor([optics.Detector()])
    for seed in range(8):
        rng = np.random.default_rng(seed)
        image, _ = ac.simulate.edge(sensor, angle_deg=angle_deg, snr=100, rng=rng, shape=(60, 60))
        assert "full_pixel" not in failed(ac.measure_edge(image))


def test_numbers_too_coarse_for_the_intervals_are_noticed():
    image, _ = edge(53, shape=(40, 40))
    coarse = np.round(image * 0.01).astype("uint8")
    assert "quantisation" in failed(ac.measure_edge(coarse))
    assert "quantisation" not in failed(ac.measure_edge(np.round(image).astype("uint16")))


@pytest.mark.parametrize("value", [4095.0, 65535.0, -32768.0, 1e30])
@pytest.mark.parametrize("count", [1, 4])
def test_bad_pixels_neither_hide_an_edge_nor_move_it(value, count):
    image, truth = edge(2, shape=(50, 50))
    rng = np.random.default_rng(count)
    image[rng.integers(50, size=count), rng.integers(50, size=count)] = value
    found = ac.measure_edge(image)
    error = found.mtf_nyquist.value - truth.mtf_nyquist.value
    assert abs(error) < 4 * found.mtf_nyquist.std < 0.05


@pytest.mark.parametrize("value", [4095.0, 65535.0, -32768.0, 1e30])
@pytest.mark.parametrize("count", [1, 4])
def test_bad_pixels_neither_hide_a_pulse_nor_move_it(value, count):
    rng = np.random.default_rng(count)
    image, truth = ac.simulate.pulse(SENSOR, snr=80, rng=rng, shape=(60, 60))
    image = np.asarray(image).copy()
    image[rng.integers(60, size=count), rng.integers(60, size=count)] = value
    found = ac.measure_pulse(image)
    assert abs(found.width_px.value - truth.width_px) < 4 * found.width_px.std < 0.1


@pytest.mark.parametrize("seed", range(4))
def test_a_strip_clipped_below_the_end_of_its_type_is_noticed(seed):
    rng = np.random.default_rng(seed)
    noise = ac.simulate.Noise(read=10, saturation=1100.0)
    image, _ = ac.simulate.pulse(SENSOR, noise=noise, offset_px=rng.uniform(-1, 1), rng=rng)
    assert "saturation" in failed(ac.measure_pulse(image))
    free, _ = ac.simulate.pulse(SENSOR, noise=ac.simulate.Noise(read=10), rng=rng)
    assert "saturation" not in failed(ac.measure_pulse(free))


@pytest.mark.parametrize("seed", range(2))
def test_a_pulse_of_two_heights_has_an_lsf_of_no_sensor(seed):
    high, _ = ac.simulate.pulse(
        SENSOR, angle_deg=11, width_px=2, offset_px=-2, dark=100, bright=1100, snr=60,
        shape=(60, 60), rng=np.random.default_rng(seed),
    )  # fmt: skip
    low, _ = ac.simulate.pulse(
        SENSOR, angle_deg=11, width_px=4, offset_px=1, dark=0, bright=500, shape=(60, 60)
    )
    found = ac.measure_pulse(high + low)
    assert "asymmetric_lsf" in failed(found)
    assert found.verdict.word == "doubtful"


def test_of_a_large_region_only_the_neighbourhood_of_the_edge_is_used():
    image, truth = edge(0, shape=(500, 500))
    found = ac.measure_edge(image)
    rows, cols = np.nonzero(found.details.used)
    assert np.max(np.abs(found.line.normal_distance(rows, cols))) < 101
    error = found.mtf_nyquist.value - truth.mtf_nyquist.value
    assert abs(error) < 4 * found.mtf_nyquist.std


def test_a_check_that_passed_gives_no_advice():
    image, _ = edge(3)
    for check in ac.measure_edge(image).checks:
        assert check.passed
        for word in ("choose", "use data", "something else", "not what the sensor"):
            assert word not in check.message, check


def test_an_edge_torn_by_missing_pixels_is_refused_with_that_reason():
    image, _ = edge(4, shape=(40, 40))
    image[np.random.default_rng(0).random(image.shape) < 0.45] = np.nan
    with pytest.raises(ac.NoEdgeError, match=r"4[0-9] % of it without data"):
        ac.measure_edge(image)


def test_checks_print_how_many_failed():
    image, _ = edge(3)
    found = ac.measure_edge(image)
    assert repr(found.checks) == f"<0 of {len(found.checks)} checks failed>"
    strict = ac.EdgeOptions(limits={"rows": 1000})
    assert repr(ac.measure_edge(image, options=strict).checks).endswith(
        f"1 of {len(found.checks)} checks failed (rows)>"
    )


def beside(truth, shape, *steps):
    """Steps of the ground (distance from the edge, share of the contrast) behind the sensor."""
    s = truth.line.normal_distance(*np.indices(shape))
    esf = truth.esf
    blurred = [h * np.interp(s - at, esf.distance_px, esf.value) for at, h in steps]
    return 1000 * sum(blurred)


@pytest.mark.parametrize("seed", range(3))
def test_a_gutter_narrower_than_the_blur_makes_the_lsf_asymmetric(seed):
    image, truth = edge(seed, shape=(60, 60), dark=200, bright=1200)
    assert "asymmetric_lsf" not in failed(ac.measure_edge(image))
    # 15 % darker for 1.5 px on the bright side.
    m = ac.measure_edge(image + beside(truth, image.shape, (0.0, -0.15), (1.5, 0.15)))
    assert "asymmetric_lsf" in failed(m)
    assert m.verdict.word == "doubtful"


@pytest.mark.parametrize("seed", range(3))
def test_two_edges_within_the_blur_of_one_another_are_invalid(seed):
    image, truth = edge(seed, shape=(60, 60), dark=200, bright=1200)
    m = ac.measure_edge(image + beside(truth, image.shape, (3.0, 0.5)))
    assert m.verdict.word == "invalid"
    assert "second peak" in m.verdict.sentence


def test_a_border_softer_than_any_camera_is_doubtful():
    soft = ac.Sensor([optics.Gaussian(1.6), optics.Detector()])
    image, _ = ac.simulate.edge(soft, snr=100, rng=np.random.default_rng(1), shape=(60, 60))
    m = ac.measure_edge(image)
    assert "lsf_narrow_px" in failed(m)
    assert m.verdict.word == "doubtful"


def test_low_contrast_is_a_note_and_very_low_contrast_a_caution():
    words = [ac.measure_edge(edge(7, snr=snr)[0]).verdict.word for snr in (50, 13, 5)]
    assert words == ["good", "usable", "doubtful"]


def with_its_noise(sensor):
    """A product's sensor before it is interpolated at one phase, and that interpolation."""
    *blocks, last = sensor.blocks
    if not isinstance(last, optics.Shift):
        return sensor, None
    return ac.Sensor(blocks), Regrid(last.row_px, last.col_px, kernel=last.kernel, a=last.a)


@pytest.mark.parametrize("family", optics.FAMILIES)
def test_few_clean_edges_of_any_family_are_warned_of(family):
    warned = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        sensor, regrid = with_its_noise(optics.draw_sensor(family, rng))
        image, _ = ac.simulate.edge(
            sensor, angle_deg=7, snr=80, shape=(45, 45), rng=rng, regrid=regrid
        )
        warned.append(ac.measure_edge(image).verdict.word in ("doubtful", "invalid"))
    # Of 60 of each, 0 to 7 % are: 3 of 8 are seen once in 60 runs at 7 %. What is interpolated at
    # one phase is uneven, as beside a strip: of 60 shifted 17 % are, of 60 processed 30 %. Coma
    # is uneven as well: of 60 aberrated 32 %, half of them as if the values bent towards a level.
    # Charge that comes a pixel late is uneven, too: of 100 deferred 29 %.
    often = {"shifted": 4, "processed": 5, "aberrated": 5, "deferred": 4}
    assert sum(warned) <= often.get(family, 2)
