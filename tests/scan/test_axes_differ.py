"""A sensor twice as sharp across as along is seldom one: borders of a direction are soft alike."""

import numpy as np
import pytest
from bare_ground import bare_ground, check_of_bare_ground

import acutance as ac
from acutance import optics
from acutance.simulate import landscape


@pytest.mark.parametrize(
    ("smear_px", "size_px", "word"),
    [(0.01, 480, "good"), (0.9, 480, "usable"), (1.3, 480, "doubtful"), (1.3, 720, "usable")],
)
def test_a_scan_says_when_its_axes_surely_differ(smear_px, size_px, word):
    """A smear of .9 px makes 43 % at Nyquist, one of 1.3 px 129 %.

    Where there are edges enough the parts of the scene were asked, and agree about it.
    """
    blocks = [optics.Gaussian(0.35), optics.Detector(), optics.Smear(smear_px, "along")]
    sensor = optics.Sensor(blocks)
    scene, check = check_of_bare_ground("axes_differ", sensor, size_px, 120, seed=7)
    assert check.passed == (word == "good")
    assert scene.verdict.word == word
    if word == "doubtful":
        assert "soft alike" in scene.verdict.sentence
    elif word == "usable":
        assert check.value > 0.25


def smeared_along(smear_px, seed):
    """A ninth of a scene whose objects are smeared along track."""
    blocks = [optics.Gaussian(0.35), optics.Detector(), optics.Smear(smear_px, "along")]
    image, _ = landscape(
        optics.Sensor(blocks), shape=(300, 300), snr=100, options=bare_ground(density_per_mpx=120),
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    return image


def test_parts_that_disagree_do_not_confirm_a_smear(few_forms):
    """Borders of one direction that are soft everywhere, here more and there less, were "usable".

    No smooth surface over the field follows this pattern of parts.
    """
    smears = ((2.1, 1.4, 1.4), (1.4, 2.1, 2.1), (2.1, 2.1, 1.4))
    rows = [[smeared_along(smears[i][j], 30 + 3 * i + j) for j in range(3)] for i in range(3)]
    with few_forms():
        scene = ac.scan_scene(np.block(rows))
    (check,) = (one for one in scene.checks if one.name == "axes_differ")
    assert check.value > 0.6
    assert check.severity == "caution"
    assert scene.verdict.word == "doubtful"
    assert "parts of the scene disagree" in scene.verdict.sentence
