"""The standard deviation of a fitted width: the scatter of many draws about the truth."""

import numpy as np
import pytest

import acutance as ac

SYSTEMS = ac.simulate.reference_systems()


@pytest.mark.parametrize("system", ["gaussian", "diffraction", "defocused"])
def test_scatter_of_the_width_is_its_standard_deviation(system):
    # A width told by the slope of the plain blur instead of the LSF scatters by 1.4 deviations
    # for diffraction and defocus.
    rng = np.random.default_rng(5)
    errors = []
    for _ in range(80):
        width_px = rng.uniform(2.6, 3.7)
        image, _ = ac.simulate.pulse(
            SYSTEMS[system],
            width_px=width_px,
            angle_deg=rng.uniform(3, 14),
            shape=(40, 45),
            offset_px=rng.uniform(-1.5, 1.5),
            snr=100.0,
            rng=rng,
        )
        found = ac.measure_pulse(image, width_px=1.03 * width_px).width_px
        errors.append((found.value - width_px) / found.std)
    assert 0.75 < np.sqrt(np.mean(np.square(errors))) < 1.22
