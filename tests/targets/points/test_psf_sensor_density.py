"""The density of sensors: what was learned, what is read, and which sensors are about a blur."""

from __future__ import annotations

import numpy as np
import pytest

from acutance import Sensor
from acutance.optics import Detector, Exponential, Gaussian, Smear, draw_sensor
from acutance.targets.points.learn_psf import departure
from acutance.targets.points.learn_sensors import (
    DENSITY_COUNTS,
    Departures,
    density,
    draw_departures,
    with_more,
    write_density,
)
from acutance.targets.points.psf_families import learned_families
from acutance.targets.points.psf_spline import GRIDS
from acutance.targets.points.sensor_density import Basis, drawn_sensors, sensors_of
from acutance.targets.points.tuned import FAMILY_LOG_AMPLITUDES, FAMILY_WEIGHTS

PIXEL = Detector()


def light(sensor, coordinates=None):
    """Coefficients of a departure on both grids, in root of light; of coordinates if given."""
    if coordinates is None:
        parts = departure(sensor)[:2]
    else:
        weights = drawn_sensors().directions @ coordinates
        parts = [one @ weights for one in learned_families().coefficients]
    return np.concatenate([g.step * c.ravel() for g, c in zip(GRIDS, parts, strict=True)])


@pytest.mark.parametrize("family", [*FAMILY_LOG_AMPLITUDES, "scatter"])
def test_sensors_never_seen_lie_in_the_coordinates(family):
    """What the coordinates leave of a new sensor's departure is a tenth of it, in the median."""
    unit = np.eye(drawn_sensors().directions.shape[1])
    columns = np.stack([light(None, one) for one in unit], axis=1)
    rng = np.random.default_rng(98)
    left = []
    for _ in range(9 if family == "processed" else 3):
        found = light(draw_sensor(family, rng))
        rest = found - columns @ np.linalg.lstsq(columns, found, rcond=None)[0]
        left.append(np.linalg.norm(rest) / np.linalg.norm(found))
    assert np.median(left) < 0.1


def test_what_is_learned_is_what_is_read(tmp_path):
    drawn = draw_departures({"halo": 3, "plain": 2}, 1)
    found = density(drawn)
    write_density(tmp_path / "one.npz", found)
    with np.load(tmp_path / "one.npz") as kept:
        assert set(kept.files) == {"basis same", "basis opposite", "basis odd", "halo", "plain"}
        for name, rows in found.items():
            assert kept[name] == pytest.approx(rows, rel=1e-3, abs=1e-6)
    assert np.exp(found["halo"][:, -2:]) == pytest.approx(np.exp(drawn["halo"].log_widths))


def test_a_trail_is_there_in_four_directions_and_round_sensors_once():
    trail = Sensor([Gaussian(0.4), Exponential(0.4, "across"), PIXEL])
    smear = Sensor([Gaussian(0.4), Smear(1.2, "across"), PIXEL])
    round_one = Sensor([Gaussian(0.6), PIXEL])
    drawn = {
        name: Departures.of([departure(sensor)])
        for name, sensor in (("trail", trail), ("smear", smear), ("plain", round_one))
    }
    found = density(drawn)
    basis = Basis(*(found.pop(f"basis {name}") for name in Basis._fields))
    sensors = sensors_of(basis, found)
    families = sensors.kernels.name[sensors.kernels.part]
    assert [np.sum(families == name) for name in drawn] == [4, 2, 1]
    log_weight = sensors.kernels.log_weight[families == "trail"]
    assert np.exp(log_weight).sum() == pytest.approx(1.0)
    wide = sensors.log_ratio[families == "smear"]
    assert wide[0] == pytest.approx(-wide[1])
    assert wide.max() > 0.2


def test_more_sensors_have_the_coordinates_of_the_first_ones():
    def departures(*sensors):
        return Departures.of(departure(one) for one in sensors)

    smear, other = (
        Sensor([Gaussian(0.4), Smear(length, "across"), PIXEL]) for length in (1.2, 0.8)
    )
    trail = Sensor([Gaussian(0.4), Exponential(0.4, "across"), PIXEL])
    kept = density({"smear": departures(smear)})
    found = with_more(kept, {"smear": departures(other), "trail": departures(trail)})
    at_once = density({"smear": departures(smear, other), "trail": departures(trail)})
    assert found.keys() == at_once.keys()
    for name, rows in at_once.items():
        np.testing.assert_allclose(found[name], rows, atol=1e-6)
    assert [len(found[name]) for name in ("smear", "trail")] == [2, 1]
    assert len(kept["smear"]) == 1


def test_the_file_holds_all_sensors():
    kernels = drawn_sensors().kernels
    whole = {name: np.exp(kernels.log_weight[kernels.name[kernels.part] == name]).sum()
             for name in DENSITY_COUNTS}  # fmt: skip
    assert whole == pytest.approx({name: FAMILY_WEIGHTS.get(name, 1.0) for name in whole})


def test_sensors_of_another_blur_have_no_part():
    sensors = drawn_sensors()
    narrow, wide = (sensors.about((width, width)) for width in (1.3, 2.4))
    assert narrow.part.size > 1000
    assert 100 < wide.part.size < narrow.part.size
    assert sensors.about((20.0, 20.0)).part.size == 0
    trailing = sensors.about((2.4, 1.3))
    assert set(trailing.name[trailing.part]) <= {
        *FAMILY_LOG_AMPLITUDES,
        "plain",
        "scatter",
        "footprint",
        "peaked",
        "deferred",
    }
    assert trailing.part.size < narrow.part.size
