"""Measurements of the same pixels of one file are found, whatever region they were measured in."""

import json
from itertools import combinations

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.optics import Detector, Gaussian, Sensor
from acutance.targets.combine.inputs import read_inputs
from acutance.targets.combine.shared_pixels import pairs_of_same_pixels

SENSOR = Sensor([Gaussian(0.4), Detector()])


def rng(seed=3):
    return np.random.default_rng(seed)


@pytest.fixture(scope="module")
def of_file(tmp_path_factory):
    """Makes a file of an array, and measures parts of it."""
    folder = tmp_path_factory.mktemp("shared")

    def measured(measure, pixels, *regions, name="image", **arguments):
        path = folder / f"{name}.npy"
        np.save(path, pixels)
        return [measure(ac.open_image(path), roi, **arguments) for roi in regions]

    return measured


def shared(*measurements):
    """Number of pairs, of results and of their documents."""
    documents = [json.loads(json.dumps(one.to_dict())) for one in measurements]
    found = [len(pairs_of_same_pixels(read_inputs(some))) for some in (measurements, documents)]
    assert found[0] == found[1]
    return found[0]


def test_mirrors_in_overlapping_regions_are_the_same(of_file):
    pixels, _ = simulate.points(SENSOR, snr=80, rng=rng())
    rows, cols = pixels.shape
    upper = rows // 2
    whole, most, top, bottom = of_file(
        ac.measure_points, pixels,
        (0, 0, rows, cols), (0, 0, rows - 14, cols), (0, 0, upper, cols),
        (upper, 0, rows - upper, cols), name="mirrors",
    )  # fmt: skip
    assert shared(whole, most) == 1
    assert shared(top, bottom) == 0
    checks = {check.name: check for check in ac.combine([whole, most]).checks}
    assert not checks["shared_targets"].passed
    # Other regions of the same mirrors in another file are other pixels.
    other = of_file(ac.measure_points, pixels, (0, 0, rows, cols), name="mirrors again")
    assert shared(whole, *other) == 0


def test_an_edge_in_two_regions_is_one_edge(of_file):
    pixels, _ = simulate.edge(SENSOR, angle_deg=6, shape=(80, 60), snr=100, rng=rng())
    whole, part, below = of_file(
        ac.measure_edge, pixels, None, (0, 0, 48, 60), (48, 0, 32, 60), name="edge"
    )
    assert shared(whole, part) == 1
    assert shared(part, below) == 0


def test_both_sides_of_a_pulse_are_edges(of_file):
    pixels, _ = simulate.pulse(SENSOR, width_px=14.0, angle_deg=6, shape=(60, 80), snr=100,
                               rng=rng())  # fmt: skip
    (pulse,) = of_file(ac.measure_pulse, pixels, None, name="strip")
    edges = of_file(ac.measure_edge, pixels, (0, 0, 60, 40), (0, 40, 60, 40), name="strip")
    for edge in edges:
        assert shared(pulse, edge) == 1
    assert shared(*edges) == 0


def test_edges_of_a_checkerboard_in_one_line_are_others(of_file):
    pixels = simulate.checkerboard(SENSOR, snr=100, rng=rng()).image
    (target,) = of_file(lambda image, _: ac.measure_edges(image), pixels, None, name="board")
    assert len(target.measurements) > 3
    for one, other in combinations(target.measurements, 2):
        assert shared(one, other) == 0


@pytest.mark.parametrize("kind", ["star", "bars"])
def test_a_periodic_target_is_found_by_its_place(of_file, kind):
    pixels, _ = getattr(simulate, kind)(SENSOR, snr=100, rng=rng())
    framed = np.pad(pixels, 12, mode="edge")
    rows, cols = pixels.shape
    measure = getattr(ac, f"measure_{kind}")
    regions = (12, 12, rows, cols), (8, 10, rows + 6, cols + 3)
    one, other = of_file(measure, framed, *regions, name=kind)
    assert one.image.roi != other.image.roi
    assert shared(one, other) == 1
