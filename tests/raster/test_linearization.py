"""Known characteristic curves turned back before anything is measured."""

import pickle

import numpy as np
import pytest

import acutance as ac
from acutance.errors import ImageError, OptionError
from acutance.raster import Box, LogCurve, PowerCurve, SrgbCurve, TableCurve

CODES = np.arange(256, dtype="uint8").reshape(16, 16)


def srgb_encoded(light):
    """IEC 61966-2-1, from light to value, both 0 to 1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def linear(array, curve):
    return ac.Image.from_array(array).linearized(curve).read()


def test_srgb_is_the_inverse_of_its_encoding():
    light = np.linspace(0, 1, 400).reshape(20, 20)
    assert linear(srgb_encoded(light), "sRGB") == pytest.approx(light, abs=2e-7)
    assert linear(255 * srgb_encoded(light), "srgb:255") == pytest.approx(255 * light, abs=6e-5)
    codes = linear(CODES, "sRGB")
    assert codes[0, 0] == 0
    assert codes[-1, -1] == pytest.approx(255)
    assert codes[7, 15] == pytest.approx(255 * 0.2122307573)


def test_a_gamma_is_the_power_of_the_values():
    assert linear(CODES, 2.2) == pytest.approx(255 * (CODES / 255) ** 2.2)
    dark = np.array([[-3.0, 2.0], [90.0, 100.0]])
    assert linear(dark, 2) == pytest.approx(np.sign(dark) * dark**2)
    assert ac.Image.from_array(CODES).linearized(PowerCurve(2.2, 255)).read() == pytest.approx(
        linear(CODES, 2.2)
    )


def test_a_logarithm_rises_by_its_decade():
    light = linear(CODES.astype(float), "log:85")
    assert light[5, 5] == pytest.approx(10.0)
    assert light[10, 10] / light[5, 5] == pytest.approx(10.0)
    assert linear(np.full((2, 2), 1.0), "log") == pytest.approx(np.e)
    with pytest.raises(ImageError, match=r"255 are 111 powers of ten of light: state .* log:85"):
        linear(CODES, "log")


def test_a_table_is_straight_in_between(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text("# film\nDN; light\n0; 0\n100; 10\n255; 320\n")
    found = linear(CODES.astype(float) * 0.5, str(path))
    assert found == pytest.approx(np.interp(CODES * 0.5, [0, 100, 255], [0, 10, 320]))
    path.write_text("0 0\n1 1\n2 4\n")
    assert linear(np.full((2, 2), 1.5), str(path)) == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,0\n10,1\n20,1\n", r"the light goes from 1 to 1 \(rows 2 and 3\): both columns have to"),
        ("0,0\n10,1\n9,2\n", "the stored value goes from 10 to 9"),
        ("DN,light\n0,0\n10,1\n", "has 2 rows of numbers: a table has 3 rows or more"),
        ("a;b\n0;0\n", "has 1 row of numbers: a table has 3 rows or more"),
        ("0,0\n10,one\n20,2\n", "has a row"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path, text, words):
    path = tmp_path / "curve.csv"
    path.write_text(text)
    with pytest.raises(OptionError, match=words):
        TableCurve.of_file(str(path))


def test_values_beyond_a_table_are_refused(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text("0,0\n100,1\n200,3\n")
    image = ac.Image.from_array(CODES).linearized(str(path))
    assert image.saturation_level is None
    with pytest.raises(ImageError, match=r"from 0 to 255, and curve\.csv rows from 0 to 200"):
        image.read()


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ("film", "film is none of the known curves .*, there is no such file"),
        (".", ". is none of the known curves .*, it cannot be read as text"),
        ("2.2", r"is the number 2\.2 .linearize=2\.2, --gamma 2\.2"),
        ("sRGB:white", "'white' has to be a number above 0"),
        ("log:-1", "'-1' has to be a number"),
        (0.0, "a gamma of 0 was asked for: it has to be 0.1 to 10"),
        ([2.2], "linearize is of type list"),
    ],
)
def test_curves_there_are_not_are_refused(asked, words):
    with pytest.raises(OptionError, match=words):
        ac.Image.from_array(CODES).linearized(asked)


def test_an_image_is_linearised_once():
    image = ac.Image.from_array(CODES).linearized("sRGB")
    assert image.linearized(None) is image
    with pytest.raises(OptionError, match=r"linearised already .sRGB"):
        image.linearized(2.2)


@pytest.mark.parametrize(
    ("values", "curve", "law"),
    [
        (CODES - 300.0, 2.2, "a power of light"),
        (CODES - 30.0, 2.2, "a power of light"),
        (np.where(CODES == 9, -9999.0, CODES), 2.2, "a power of light"),
        (CODES.astype("int16") - 400, 0.5, "a power of light"),
        (CODES / 255.0 - 0.2, "sRGB", "sRGB"),
        (CODES - 100.0, "sRGB:255", "sRGB"),
    ],
)
def test_values_far_below_zero_are_no_power_of_light(values, curve, law):
    """They were mirrored about 0 silently."""
    lowest = f"values down to {np.min(values):g}, and {law} is never below 0: add what was"
    with pytest.raises(ImageError, match=lowest):
        linear(values, curve)


def test_noise_about_zero_keeps_its_sign_behind_a_power():
    noise = np.random.default_rng(2).normal(0.0, 0.01, (20, 20))
    values = noise + np.where(np.arange(20) < 10, 0.0, 0.8)
    found = linear(values, 1.5)
    assert np.array_equal(np.sign(found), np.sign(values))


def test_srgb_of_floats_beyond_one_is_refused():
    with pytest.raises(ImageError, match="values up to 200: state the value of white"):
        linear(np.full((4, 4), 200.0), "sRGB")


def test_limits_and_unusable_pixels_go_through_the_curve(tmp_path):
    array = np.ma.masked_equal(CODES, 7)
    image = ac.Image.from_array(array, nodata=9).linearized(2.0)
    assert image.saturation_level == pytest.approx(255.0)
    assert np.isnan(image.read(Box(0, 0, 1, 16))[0]).nonzero()[0].tolist() == [7, 9]
    assert image.characteristic == PowerCurve(2.0, 255.0)
    assert ac.Image.from_array(CODES).linearized("log:255").saturation_level == pytest.approx(10)
    assert np.array_equal(pickle.loads(pickle.dumps(image)).read(), image.read(), equal_nan=True)
    np.save(tmp_path / "codes.npy", CODES)
    opened = ac.open_image(tmp_path / "codes.npy", linearize="sRGB")
    assert np.array_equal(opened.read(), linear(CODES, SrgbCurve(255.0)))
    assert LogCurve(85).words == "logarithm, 85 for ten times the light"


def gamma_edge(seed, snr=100.0, gamma=2.2, **options):
    """An edge of 8 bits behind a gamma, and its truth."""
    rng = np.random.default_rng(seed)
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    image, truth = ac.simulate.edge(
        sensor, **{"angle_deg": 6, "shape": (50, 50), "dark": 20, "bright": 200, **options},
        snr=snr, rng=rng,
    )  # fmt: skip
    values = 255 * (np.clip(np.asarray(image), 0, 255) / 255) ** (1 / gamma)
    return np.round(values).astype("uint8"), truth


def test_a_linearised_edge_gives_the_sensor_and_says_so():
    values, truth = gamma_edge(1)
    found = ac.measure_edge(ac.Image.from_array(values).linearized(2.2))
    assert abs(found.rer.value - truth.rer.value) < 3 * found.rer.std < 0.02
    assert found.record.image.linearized == "gamma 2.2, full scale 255"
    assert ac.Record.from_dict(found.to_dict()).image == found.image
    assert "gamma 2.2" in ac.report.page(found)
    plain = ac.measure_edge(values)
    assert plain.image.linearized is None
    assert "nonlinearity" in {check.name for check in plain.failed_checks}
    (failed,) = (check for check in plain.failed_checks if check.name == "nonlinearity")
    assert "linearise the image by its known curve" in failed.message


@pytest.mark.parametrize("measure", ["edge", "star"])
def test_an_image_that_was_linearised_wrongly_is_not_told_to_linearise_it(measure):
    if measure == "edge":
        values, _ = gamma_edge(1, gamma=1.0, dark=50)
        found = ac.measure_edge(ac.Image.from_array(values).linearized(2.2))
    else:
        sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
        light, _ = ac.simulate.star(
            sensor, cycles=18, dark=40.0, bright=220.0, snr=200, rng=np.random.default_rng(1)
        )
        dark, bright = PowerCurve(2.2, 255.0).linear(np.array([40.0, 220.0])).tolist()
        found = ac.measure_star(
            ac.Image.from_array(np.asarray(light)).linearized(PowerCurve(2.2, 255.0)),
            cycles=18,
            options=ac.StarOptions(dark=dark, bright=bright),
        )
    (failed,) = (check for check in found.failed_checks if check.name == "nonlinearity")
    assert "was linearised (gamma 2.2, full scale" in failed.message
    assert "is this its curve, with the right white and power?" in failed.message
    assert "--linearize" not in failed.message


def test_intervals_hold_where_the_dark_has_been_stretched():
    z = []
    for seed in range(60):
        values, truth = gamma_edge(
            seed,
            angle_deg=3 + seed % 15,
            dark=(8, 20, 50)[seed % 3],
            bright=(120, 180, 220)[seed % 3],
        )
        found = ac.measure_edge(ac.Image.from_array(values).linearized(2.2))
        z.append(
            [
                (mine.value - true) / mine.std
                for mine, true in (
                    (found.mtf_nyquist, truth.mtf_nyquist.value),
                    (found.mtf(0.25), truth.mtf(0.25).value),
                    (found.rer, truth.rer.value),
                    (found.fwhm_px, truth.fwhm_px.value),
                )
            ]
        )
    scatter = np.sqrt(np.mean(np.square(z), axis=0))
    # The prior of an LSF is wide of a Gaussian: linear edges scatter by .75 to .95 as well.
    assert np.all((scatter > 0.65) & (scatter < 1.05)), scatter


def test_clipping_and_coarse_steps_are_found_behind_the_curve():
    values, _ = gamma_edge(3, bright=300)
    clipped = ac.measure_edge(ac.Image.from_array(values).linearized(2.2))
    assert "saturation" in {check.name for check in clipped.failed_checks}
    assert clipped.verdict.word == "invalid"
    values, _ = gamma_edge(4, snr=2000)
    coarse = ac.measure_edge(ac.Image.from_array(values).linearized(2.2))
    assert "quantisation" in {check.name for check in coarse.failed_checks}
    values, _ = gamma_edge(5)
    fine = ac.measure_edge(ac.Image.from_array(values).linearized(2.2))
    assert fine.verdict.word == "good", fine.verdict
