"""Sharpness over the field: modes of blur, their fit, and the sensor at a place."""

import numpy as np
import pytest

from acutance.curves import Otf2d
from acutance.optics import Detector, Gaussian, Sensor
from acutance.scan.blur_modes import blur_modes, changed, edge_modes, fit_modes, quartic_modes
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.field import Field, field_polynomials
from acutance.scan.field_fit import fit_field
from acutance.scan.information import mode_information
from acutance.scan.population import fit_shares
from acutance.scan.shares import START

FREQ = np.arange(0.1, 0.75, 0.1)
NORMALS = np.array([-60.0, -20.0, 10.0, 40.0, 80.0])
STD = 0.02
RNG = np.random.default_rng


def gaussian(variance):
    return np.exp(-2 * np.pi**2 * variance * FREQ**2)


def drawn(variance, soft_share=0.0, count=800, seed=0):
    """Edges under a blur of `variance(x, y, normal)`, and where they lie."""
    rng = RNG(seed)
    x, y = rng.uniform(-1, 1, (2, count))
    bins = rng.integers(0, NORMALS.size, count)
    tau = np.where(rng.random(count) < soft_share, rng.uniform(0.2, 1.5, count), 0.0)
    normals = NORMALS[bins]
    own = np.array([
        gaussian(variance(x[i], y[i], normals[i]) + tau[i] ** 2) for i in range(count)
    ])  # fmt: skip
    seen = np.hstack([own, np.zeros_like(own)]) + rng.normal(0, STD, (count, 2 * FREQ.size))
    root = np.broadcast_to(np.eye(2 * FREQ.size) / STD, (count, *(2 * [2 * FREQ.size])))
    rank = np.full(count, 2.0 * FREQ.size)
    return EdgeLikelihoods.of_roots(FREQ, root, seen / STD, rank, bins, normals), x, y


def test_the_information_is_that_of_the_amounts_that_were_found():
    edges, _, _ = drawn(constant, soft_share=0.6, count=200)
    modes = edge_modes(NORMALS, FREQ)[:, :, :3]
    wrong = changed(middle(constant), modes[:, :, 0] * 0.03)
    found = fit_modes(edges, wrong, START, modes[edges.bin])
    there = fit_shares(edges.turned(np.exp(modes[edges.bin] @ found.amount)), wrong, found.share)
    _, information = mode_information(there, modes[edges.bin])
    np.testing.assert_allclose(found.information, information, rtol=1e-3, atol=500.0)


def settled(edges, x, y):
    """The field after some turns: sensor and field, one given the other."""
    otf, share, modes = middle(constant), START, edge_modes(NORMALS, FREQ)[:, :, :3]
    field = fit_field(edges, otf, share, x, y)
    for _ in range(4):
        otf = changed(otf, modes @ field.common)
        field = fit_field(edges, otf, share, x, y, field)
    return field


def middle(variance):
    one = np.array([gaussian(variance(0.0, 0.0, n)) for n in NORMALS])
    return np.hstack([one, np.zeros_like(one)])


def constant(x, y, normal):
    return 0.25


def tilted(x, y, normal):
    return 0.25 + 0.04 * x


def test_modes_are_blurs():
    turn = np.radians(30.0)
    u, v = FREQ * np.cos(turn), FREQ * np.sin(turn)
    modes = blur_modes(u, v)
    assert np.exp(0.1 * modes[:, 0]) == pytest.approx(gaussian(0.1))
    across, along = gaussian(0.1 * np.cos(turn) ** 2), gaussian(0.1 * np.sin(turn) ** 2)
    assert np.exp(0.05 * (modes[:, 0] + modes[:, 1])) == pytest.approx(across)
    assert np.exp(0.05 * (modes[:, 0] - modes[:, 1])) == pytest.approx(along)
    assert blur_modes(np.array([0.25]), np.array([0.0]))[0, 3] == pytest.approx(
        blur_modes(np.array([0.25]), np.array([0.0]))[0, 0]
    )
    assert blur_modes(np.array([0.0, 0.5, 0.9]), np.zeros(3))[:, 3] == pytest.approx(0, abs=1e-12)


def test_modes_of_fourth_order_are_all_there_are():
    """Any homogeneous polynomial of fourth order in both frequencies is a sum of the five."""
    normals = np.linspace(-90, 80, 18)
    u, v = np.cos(np.radians(normals))[:, None] * FREQ, np.sin(np.radians(normals))[:, None] * FREQ
    modes = quartic_modes(normals, FREQ).reshape(-1, 5)
    for power in range(5):
        wanted = (u ** (4 - power) * v**power).ravel()
        amount, *_ = np.linalg.lstsq(modes, wanted, rcond=None)
        assert modes @ amount == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("off", [-0.03, 0.03])
def test_a_blur_of_all_objects_is_told_from_the_sensors(off):
    edges, _, _ = drawn(constant, soft_share=0.6)
    modes = edge_modes(NORMALS, FREQ)[:, :, :3]
    wrong = changed(middle(constant), modes[:, :, 0] * off)
    found = fit_modes(edges, wrong, START, modes[edges.bin])
    left = off + found.amount[0]
    std = np.linalg.inv(found.information)[0, 0] ** 0.5
    assert abs(left) < 4 * std
    assert std < 0.004
    assert np.abs(found.amount[1:]).max() < 0.01


def test_a_constant_field_is_called_constant():
    edges, x, y = drawn(constant)
    field = fit_field(edges, middle(constant), START, x, y)
    assert field.chance_constant > 0.9
    assert np.abs(field.amount).max() < 0.002


def test_soft_objects_make_no_field():
    edges, x, y = drawn(constant, soft_share=0.6)
    assert fit_field(edges, middle(constant), START, x, y).chance_constant > 0.9


def test_few_edges_are_not_asked():
    edges, x, y = drawn(tilted, count=50)
    field = fit_field(edges, middle(tilted), START, x, y)
    assert field.chance_constant == 0.5
    assert not field.amount.any()
    assert not field.log_gain.any()
    edges, x, y = drawn(tilted, count=120)
    field = fit_field(edges, middle(tilted), START, x, y)
    assert not field.amount.reshape(5, 4)[2:].any()
    assert field.amount.reshape(5, 4)[0, 0] > 0.005


def test_a_change_over_the_field_is_found_within_its_deviation():
    off, held = [], []
    places = np.array([[-0.9, 0.2], [0.9, 0.9], [0.0, -0.7]])
    for seed in range(12):
        edges, x, y = drawn(tilted, soft_share=0.3, count=400, seed=seed)
        field = settled(edges, x, y)
        assert field.chance_constant < 0.01
        weight = field_polynomials(*places.T)[:, :, None] - field.middle
        allround = weight[:, :, 0] @ field.amount.reshape(5, 4)[:, 0]
        spread = weight[:, :, 0] @ field.root.reshape(5, 4, -1)[:, 0]
        change = 0.04 * (places[:, 0] - field.middle[0, 0])
        off += list(allround - change)
        held += list(np.abs(allround - change) < 2 * np.linalg.norm(spread, axis=1))
    assert np.std(off) < 0.006
    assert np.mean(held) > 0.85


class Plain:
    """A sensor as a model without errors."""

    band_cpp = 3.0

    def __init__(self, sensor):
        self.otf = sensor.otf

    def factor(self, u, v):
        return np.zeros((u.size, 0), complex)


def test_the_sensor_at_a_place():
    amount = np.zeros((5, 4))
    amount[0, 0], amount[2, 0] = 0.05, 0.02
    root = np.zeros((20, 1))
    root[0] = 0.01
    field = Field((10, 20, 100, 201), np.zeros((5, 4)), amount.ravel(), root, 0.0)
    base = Plain(Sensor([Gaussian(0.4), Detector()]))
    u, v = np.array([0.0, 0.3, 0.5]), np.array([0.0, 0.1, 0.0])
    right = field.at(base, 59.5, 220.5)
    added = Sensor([Gaussian(0.4), Gaussian(0.07**0.5), Detector()])
    assert right.otf(u, v) == pytest.approx(added.otf(u, v))
    assert np.all(right.factor(u, v)[0] == 0)
    std = np.linalg.norm(right.factor(u, v)[2])
    assert std == pytest.approx(2 * np.pi**2 * 0.25 * 0.01 * abs(added.otf(u, v)[2]))
    assert Otf2d(right).response(0.0).mtf_nyquist.std == pytest.approx(std, rel=1e-3)
    change, own_std = field.change(59.5, 220.5, u, v)
    mean = field.mean_of(base).otf(u, v)
    assert np.exp(change) == pytest.approx(np.abs(right.otf(u, v) / mean))
    assert own_std[2] == pytest.approx(2 * np.pi**2 * 0.25 * 0.01)
    rows, cols = field.grid(2, 3)
    assert rows.tolist() == [34.5, 84.5]
    assert cols.tolist() == pytest.approx([53.0, 120.0, 187.0])
    assert field.holds(10, 20)
    assert not field.holds(9, 20)
    # The mean of the logarithm over the field is that of the middle: polynomials have no mean.
    fine_rows, fine_cols = field.grid(40, 80)
    logs = [np.log(np.abs(field.at(base, i, j).otf(u, v))) for i in fine_rows for j in fine_cols]
    assert np.mean(logs, axis=0) == pytest.approx(np.log(np.abs(base.otf(u, v))), abs=1e-3)
