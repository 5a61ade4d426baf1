"""Standard deviations of a pulse mean what they say; phase, axes and metres are the sensor's."""

import numpy as np
import pytest

import acutance as ac

SYSTEMS = ac.simulate.reference_systems()
NAMES = ("mtf_nyquist", "width_px")
LOWEST, HIGHEST = 0.88, 1.13
"""Bounds on the root mean square of error over standard deviation."""


@pytest.fixture(scope="module")
def errors():
    """Errors in standard deviations, (draws, len(NAMES)), pooled over systems and angles."""
    rng = np.random.default_rng(5)
    found = []
    for draw in range(20 * len(SYSTEMS)):
        width_px = rng.uniform(2.6, 3.7)
        image, truth = ac.simulate.pulse(
            list(SYSTEMS.values())[draw % len(SYSTEMS)],
            width_px=width_px,
            angle_deg=rng.uniform(3, 14),
            shape=(40, 45),
            offset_px=rng.uniform(-1.5, 1.5),
            snr=100.0,
            rng=rng,
        )
        # A width taken from the slope of the Gaussian instead of the LSF scatters by 1.4
        # deviations for diffraction and defocus.
        m = ac.measure_pulse(image, width_px=1.03 * width_px)
        pairs = ((m.mtf_nyquist, truth.mtf_nyquist.value), (m.width_px, width_px))
        found.append([(one.value - true) / one.std for one, true in pairs])
    return np.array(found)


@pytest.mark.parametrize("column", range(len(NAMES)), ids=NAMES)
def test_scatter_is_the_standard_deviation(errors, column):
    scatter = float(np.sqrt(np.mean(errors[:, column] ** 2)))
    assert LOWEST < scatter < HIGHEST
    # The bounds notice standard deviations wrong by a quarter.
    assert scatter / 0.8 > HIGHEST
    assert scatter / 1.25 < LOWEST


def test_an_asymmetric_sensor_keeps_its_phase():
    image, truth = ac.simulate.pulse(
        SYSTEMS["asymmetric"], width_px=3.3, angle_deg=7, snr=200, rng=np.random.default_rng(2)
    )
    m = ac.measure_pulse(image, width_px=3.3)
    at = int(np.argmin(np.abs(m.mtf.freq_cpp - 0.3)))
    true = float(np.interp(0.3, truth.mtf.freq_cpp, truth.mtf.phase_rad))
    assert abs(true) > 0.05
    assert m.mtf.phase_rad[at] == pytest.approx(true, abs=0.5 * abs(true))


@pytest.mark.parametrize(("orientation", "gsd_m"), [("across", 0.7), ("along", 0.5)])
def test_metres_are_those_along_the_normal(orientation, gsd_m):
    image, _ = ac.simulate.pulse(
        SYSTEMS["gaussian"], width_px=3.0, angle_deg=3, orientation=orientation, snr=100,
        rng=np.random.default_rng(1),
    )  # fmt: skip
    m = ac.measure_pulse(image, width_px=3.0, gsd_m=ac.Gsd(row_m=0.5, col_m=0.7))
    assert m.orientation == orientation
    assert m.response.gsd_m == pytest.approx(gsd_m, rel=0.003)
    assert m.pulse_numbers()["width_m"].value == pytest.approx(3 * gsd_m, rel=0.02)
