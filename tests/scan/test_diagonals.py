"""A blur that lies along neither rows nor columns is that of objects, or of an image turned."""

import numpy as np
import pytest
from bare_ground import bare_ground

import acutance as ac
from acutance import optics, simulate


class Oblique:
    """A Gaussian blur whose axes are the diagonals."""

    def otf(self, u, v):
        p, q = (u + v) / np.sqrt(2), (v - u) / np.sqrt(2)
        return np.asarray(np.exp(-2 * np.pi**2 * ((0.30 * p) ** 2 + (0.45 * q) ** 2)))


@pytest.mark.parametrize(
    ("blur", "word"), [(optics.Gaussian(0.4, 0.45), "good"), (Oblique(), "doubtful")]
)
def test_a_sensor_is_the_same_along_both_diagonals(blur, word):
    sensor = optics.Sensor([blur, optics.Detector()])
    image, _ = simulate.landscape(
        sensor, shape=(700, 700), snr=100, options=bare_ground(density_per_mpx=90),
        rng=np.random.default_rng(5),
    )  # fmt: skip
    scene = ac.scan_scene(image)
    (check,) = (one for one in scene.checks if one.name == "diagonals")
    assert check.passed == (word == "good")
    assert scene.verdict.word == word
    if word == "doubtful":
        assert "diagonal" in scene.verdict.sentence
