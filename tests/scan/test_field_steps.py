"""Two detectors side by side are no smooth change over the field: the scan says so."""

import numpy as np
import pytest
from bare_ground import bare_ground

import acutance as ac
from acutance import optics
from acutance.simulate import landscape


def side(blur_px, seed):
    """Half a scene under a detector of its own."""
    sensor = optics.Sensor([optics.Gaussian(blur_px), optics.Detector()])
    image, _ = landscape(
        sensor, shape=(700, 350), snr=100, options=bare_ground(density_per_mpx=160, soft=0.0),
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    return image


@pytest.mark.parametrize(("blurs_px", "word"), [((0.38, 0.38), "good"), ((0.38, 0.44), "doubtful")])
def test_a_step_of_sharpness_is_no_smooth_change(blurs_px, word, few_forms):
    image = np.hstack([side(blur, 3 + i) for i, blur in enumerate(blurs_px)])
    with few_forms():
        scene = ac.scan_scene(image)
    (check,) = (one for one in scene.checks if one.name == "field_change")
    assert check.passed == (word == "good")
    assert scene.verdict.word == word
    if word == "doubtful":
        assert check.severity == "caution"
        assert "no smooth one" in scene.verdict.sentence
