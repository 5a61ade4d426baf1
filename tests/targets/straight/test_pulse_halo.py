"""The halo of a pulse's LSF as a cause of error of its own."""

from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import pulse, reference_systems
from acutance.targets.straight.find_pulse import find_pulse
from acutance.targets.straight.fit_pulse import fit_pulse
from acutance.targets.straight.lsf import with_uncertain_halo
from acutance.targets.straight.pulse_halo import halo, with_halo_error
from acutance.targets.straight.tuned import HALO_SHARE

SYSTEMS = reference_systems()


def fitted(name, seed=0, **changes):
    options = {"width_px": 3.0, "angle_deg": 8.0, "shape": (45, 50), "snr": 90.0} | changes
    image, truth = pulse(SYSTEMS[name], rng=np.random.default_rng(seed), **options)
    trimmed, _ = find_pulse(image, 3.0)
    return fit_pulse(trimmed).response, truth


def test_the_curves_stay_and_err_together():
    plain, _ = fitted("halo")
    uncertain = with_uncertain_halo(plain)
    assert uncertain.rer.value == plain.rer.value
    assert np.array_equal(uncertain.mtf.otf, plain.mtf.otf)
    causes = [curve.covariance_factor[:, -1] for curve in (uncertain.esf, uncertain.lsf)]
    step = 0.05
    # One error in three forms: the LSF's is the ESF's slope, and its transform the OTF's.
    assert np.gradient(causes[0], step)[1:-1] == pytest.approx(causes[1][1:-1], abs=2e-4)
    at = uncertain.mtf.freq_cpp[:60, None] * uncertain.lsf.distance_px
    transform = np.abs(np.exp(-2j * np.pi * at) @ causes[1]) * step
    assert np.abs(uncertain.mtf.factor[:60, -1]) == pytest.approx(transform, abs=1e-5)
    assert uncertain.mtf.std[0] == pytest.approx(0, abs=1e-9)


def test_the_width_grows_by_the_share_of_the_foot_alone():
    for name, grows in (("halo", 1.25), ("gaussian", 1.0), ("wide", 1.0), ("sharpened", 1.0)):
        plain, _ = fitted(name)
        uncertain = with_uncertain_halo(plain)
        ratio = uncertain.mtf(0.25).std / plain.mtf(0.25).std
        assert ratio > grows if name == "halo" else ratio < 1.12
    light = halo(plain.lsf, plain.fwhm_px.value)
    assert light.min() >= 0


def test_truths_have_one_cause():
    _, truth = fitted("halo")
    esf, lsf, mtf = with_halo_error(truth.response, HALO_SHARE)
    uncertain = replace(truth.response, esf=esf, lsf=lsf, mtf=mtf)
    energy = halo(truth.lsf, truth.fwhm_px.value).sum() * 0.05
    # RER loses about its own share of what the halo holds.
    assert uncertain.rer.std == pytest.approx(HALO_SHARE * energy * truth.rer.value, rel=0.25)


def test_intervals_of_a_halo_hold_the_truth():
    z = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        image, truth = pulse(
            SYSTEMS["halo"], width_px=3.0, angle_deg=float(rng.uniform(3, 14)), shape=(45, 50),
            snr=90, rng=rng,
        )  # fmt: skip
        m = ac.measure_pulse(image, width_px=3.0)
        z.append((m.rer.value - truth.rer.value) / m.rer.std)
    # Without the halo's own term 20 to 27 of 40 are held.
    assert np.mean(np.abs(z) < 1.96) >= 0.75
