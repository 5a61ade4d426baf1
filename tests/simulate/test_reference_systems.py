"""The shared systems keep the shapes their descriptions promise."""

import numpy as np
import pytest

from acutance.simulate import reference_systems

SYSTEMS = reference_systems()


def test_names():
    assert list(SYSTEMS) == [
        "gaussian",
        "wide",
        "diffraction",
        "halo",
        "sharpened",
        "asymmetric",
        "smeared",
        "defocused",
    ]


@pytest.mark.parametrize("name", SYSTEMS)
def test_transfer_at_nyquist_is_that_of_a_usable_image(name):
    assert 0.05 < SYSTEMS[name].response(6.0).mtf_nyquist.value < 0.6


@pytest.mark.parametrize("name", SYSTEMS)
def test_only_the_sharpened_system_overshoots(name):
    overshoot = SYSTEMS[name].response(6.0).overshoot.value
    assert (0.08 < overshoot < 0.10) if name == "sharpened" else overshoot < 1e-6


@pytest.mark.parametrize("name", SYSTEMS)
def test_only_the_asymmetric_system_has_phase(name):
    phase = np.max(np.abs(SYSTEMS[name].response(6.0).mtf.otf.imag))
    assert (phase > 0.02) == (name == "asymmetric")


def test_feet_of_halo_and_aperture_reach_far():
    wings = {name: 1 - system.profile(6.0).esf(5.0) for name, system in SYSTEMS.items()}
    assert wings["gaussian"] < 1e-6
    assert 5e-4 < wings["halo"] < 5e-3
    assert wings["diffraction"] > 5e-3
