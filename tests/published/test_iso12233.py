"""The slanted-edge method: the gains of its steps, and the reference program on a real chart."""

import math
from pathlib import Path

import numpy as np
import pytest
from closed_form_edge import edge_band, gaussian_pixel_esf, gaussian_pixel_mtf

from acutance.errors import OptionError
from acutance.geometry.line import Line
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.published import Iso12233Options, iso12233
from acutance.targets.straight.published.windows import hamming_window, tukey_window

IRRATIONAL_DEG = math.degrees(math.atan((math.sqrt(5) - 1) / 6))
DATA = Path(__file__).parents[3] / "shared" / "data"


def hann_gain(freq_cpp, width_px):
    """What a Hann window does to the LSF after bins of 0.25 px and a difference over 0.5 px."""
    x = np.arange(-width_px / 2, width_px / 2, 0.01)
    within = np.arange(-0.12, 0.13, 0.01)[:, None]
    rise = gaussian_pixel_esf(x + within + 0.25) - gaussian_pixel_esf(x + within - 0.25)
    lsf = rise.mean(axis=0)
    wave = np.exp(-2j * np.pi * freq_cpp * x)
    tapered = lsf * np.cos(np.pi * x / width_px) ** 2
    return abs(wave @ tapered) / tapered.sum() * lsf.sum() / abs(wave @ lsf)


def test_window_bias_follows_the_second_derivative_of_the_mtf():
    h = 1e-3
    at = {f: gaussian_pixel_mtf(np.array([f - h, f, f + h]), 0.5) for f in (0.0, 0.5)}
    bend = {f: (m[0] - 2 * m[1] + m[2]) / h**2 for f, m in at.items()}
    # +11 % at Nyquist for a window of 10 px and a sigma of 0.5 px.
    assert (bend[0.5] / at[0.5][1] - bend[0.0]) / (4 * 10**2) == pytest.approx(0.11, abs=5e-3)


@pytest.mark.parametrize("bins_per_px", [4, 8])
def test_bins_cost_their_sinc(bins_per_px):
    trimmed = edge_band(angle_deg=IRRATIONAL_DEG, shape=(800, 110))
    options = Iso12233Options(bins_per_px=bins_per_px, replicates=0)
    found = iso12233(trimmed, options).response.mtf_nyquist.value / gaussian_pixel_mtf(0.5)
    loss = np.sinc(0.5 / bins_per_px)
    assert found == pytest.approx(loss, abs=3.5e-3)


def test_four_bins_lose_2_55_percent_at_nyquist():
    assert np.sinc(0.5 / 4) - 1 == pytest.approx(-0.0255, abs=5e-5)


@pytest.mark.parametrize("width_px", [12.0, 20.0])
def test_a_narrow_window_raises_the_mtf(width_px):
    trimmed = edge_band(angle_deg=IRRATIONAL_DEG, shape=(400, 120))
    row, col = np.mgrid[:400, :120]
    distance = trimmed.line.normal_distance(row, col)
    image = np.where(np.abs(distance) <= width_px / 2, trimmed.image, np.nan)
    narrow_band = EdgePixels(image, trimmed.line, trimmed.dark, trimmed.bright, 0.5, 0.0)
    wide = iso12233(trimmed, Iso12233Options(replicates=0)).response
    narrow = iso12233(narrow_band, Iso12233Options(replicates=0)).response
    ratio = narrow.mtf_nyquist.value / wide.mtf_nyquist.value
    # Half of the rows reach half a pixel less on each side; the difference costs two bins.
    assert ratio - 1 == pytest.approx(hann_gain(0.5, width_px - 1.25) - 1, rel=0.1)


def test_curves_run_along_the_normal():
    for angle_deg in (4.0, 20.0):
        trimmed = edge_band(angle_deg=angle_deg, shape=(400, 150))
        response = iso12233(trimmed, Iso12233Options(bins_per_px=8, replicates=0)).response
        truth = gaussian_pixel_mtf(0.25)
        assert response.mtf(0.25).value / truth == pytest.approx(1.0, abs=6e-3)


def test_windows_taper_as_named():
    x = np.array([0.0, 2.0, 3.0, 4.0, 5.0])
    np.testing.assert_allclose(tukey_window(x, 4.0, 1.0), [1, 0.5, 0.1464466, 0, 0], atol=1e-7)
    np.testing.assert_allclose(tukey_window(x, 4.0, 0.5), [1, 1, 0.5, 0, 0], atol=1e-12)
    np.testing.assert_allclose(hamming_window(x[[0, 3]], 4.0), [1.0, 0.08], atol=1e-12)


def test_hamming_of_older_editions_is_available():
    trimmed = edge_band()
    tukey = iso12233(trimmed, Iso12233Options(replicates=0)).response.mtf_nyquist.value
    hamming = iso12233(trimmed, Iso12233Options(window="hamming", replicates=0))
    assert hamming.response.mtf_nyquist.value == pytest.approx(tukey, rel=5e-3)
    assert hamming.response.mtf_nyquist.value != tukey


def test_a_polynomial_follows_a_bent_edge():
    rows, cols = 200, 40
    row, col = np.mgrid[:rows, :cols]
    line = Line(99.5, 19.5, 5.0)
    bow = 0.6 * ((row - 99.5) / 100) ** 2
    image = 200 + 1000 * gaussian_pixel_esf(line.normal_distance(row, col) - bow)
    trimmed = EdgePixels(image, line, 200.0, 1200.0, 0.5, 0.0)
    straight = iso12233(trimmed, Iso12233Options(replicates=0)).response.mtf_nyquist.value
    bent = iso12233(trimmed, Iso12233Options(edge_order=2, replicates=0)).response.mtf_nyquist.value
    truth = np.sinc(0.125) * gaussian_pixel_mtf(0.5)
    assert bent == pytest.approx(truth, rel=0.015)
    assert straight < 0.97 * bent


@pytest.mark.parametrize(
    "wrong", [{"bins_per_px": 0}, {"edge_order": 6}, {"window": "hann"}, {"tukey_alpha": 0.0}]
)
def test_meaningless_options_are_refused(wrong):
    with pytest.raises(OptionError, match=r"found|give"):
        Iso12233Options(**wrong)


@pytest.mark.real
@pytest.mark.parametrize(("channel", "mtf50_cpp"), [(0, 0.270), (1, 0.273), (2, 0.276)])
def test_reference_program_on_its_own_chart(channel, mtf50_cpp):
    image_path = DATA / "03_sfrmat5_chart_edge1_rgb.tif"
    if not image_path.exists():
        pytest.skip(f"the folder of real images is absent: {DATA}")
    image = _read(image_path)[channel]
    trimmed = _chart_band(image)
    # The chart's edge is bent by the lens: the reference program follows it with order 5.
    response = iso12233(trimmed, Iso12233Options(edge_order=5, replicates=0)).response
    assert response.mtf50_cpp.value == pytest.approx(mtf50_cpp, rel=0.01)

    table = np.genfromtxt(DATA / "03_sfrmat5_reference_sfr.csv", delimiter=",", skip_header=1)
    table = table[table[:, 0] <= 0.5]
    ours = np.interp(table[:, 0], response.mtf.freq_cpp, response.mtf.value)
    np.testing.assert_allclose(ours, table[:, 1 + channel], atol=0.01)

    straight = iso12233(trimmed, Iso12233Options(replicates=0)).response
    assert straight.mtf50_cpp.value == pytest.approx(mtf50_cpp, rel=0.045)


def _read(path):
    import warnings

    import rasterio

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        with rasterio.open(path) as dataset:
            return dataset.read().astype(float)


def _chart_band(image):
    angle_deg = math.degrees(math.atan2(79.9 - 46.9, 342.0))
    dark, bright = float(image[-20:].mean()), float(image[:20].mean())
    return EdgePixels(image, Line(46.9, 0.0, angle_deg - 90.0), dark, bright, 0.8, 1.0)
