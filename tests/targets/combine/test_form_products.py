"""Forms of sensors side by side: the same as each alone."""

import numpy as np
import pytest

from acutance import optics
from acutance.targets.combine.curves import OtfSamples, WhitenedCurves
from acutance.targets.combine.form_fit import fit_forms, likely_starts
from acutance.targets.combine.form_products import FormProducts
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_forms import FORMS, SensorForm

PLANE = Plane(*np.random.default_rng(2).uniform(-0.8, 0.8, (2, 30)))
DETECTOR_PX = (1.1, 0.9)
FORMS_SIDE_BY_SIDE = (*FORMS, ("upright gaussian", "upright smear"), ("round gaussian",), FORMS[3])


@pytest.fixture(scope="module")
def products():
    return FormProducts(FORMS_SIDE_BY_SIDE, DETECTOR_PX)


@pytest.fixture(scope="module")
def parameters(products):
    away = 0.5 * products.std * np.random.default_rng(3).standard_normal(products.mean.shape)
    return products.mean + np.where(products.std == 1, 0.3, 1.0) * away


def alone(products, parameters):
    """Every form with its own parameters."""
    for terms, count, p in zip(products.terms, products.counts, parameters, strict=True):
        yield SensorForm(terms, DETECTOR_PX), p[:count]


def test_every_form_has_the_values_and_slopes_it_has_alone(products, parameters):
    factors = products.factors(parameters, PLANE)
    slopes = products.slopes(parameters, PLANE, factors)
    for i, (form, p) in enumerate(alone(products, parameters)):
        np.testing.assert_allclose(
            factors[:, i].prod(axis=0), form.otf_on(p, PLANE), rtol=1e-9, atol=1e-12
        )
        np.testing.assert_allclose(
            slopes[i, : p.size].T, form.slopes_on(p, PLANE), rtol=1e-6, atol=1e-9
        )
        assert not slopes[i, p.size :].any()


def test_some_of_them_are_the_same(products, parameters):
    kept = np.array([0, 7, 8, len(FORMS) + 2])
    some = products.some(kept)
    assert some.terms == tuple(FORMS_SIDE_BY_SIDE[i] for i in kept)
    np.testing.assert_array_equal(some.mean, products.mean[kept])
    np.testing.assert_array_equal(some.std, products.std[kept])
    found = some.factors(parameters[kept], PLANE).prod(axis=0)
    np.testing.assert_allclose(found, products.factors(parameters, PLANE)[:, kept].prod(axis=0))
    # A choice of a choice, too.
    np.testing.assert_array_equal(some.some(np.array([1, 3])).mean, products.mean[kept[[1, 3]]])


def test_parameters_a_form_has_not_change_nothing(products, parameters):
    beyond = np.arange(products.mean.shape[1]) >= products.counts[:, None]
    moved = np.where(beyond, 7.0, parameters)
    assert beyond.any()
    np.testing.assert_array_equal(
        products.factors(moved, PLANE), products.factors(parameters, PLANE)
    )
    assert (products.mean[beyond] == 0).all()
    assert (products.std[beyond] == 1).all()


def test_forms_fitted_side_by_side_are_those_fitted_alone():
    freq = np.arange(1, 13) * 0.05
    sensor = optics.Sensor([optics.Gaussian(0.4, 0.45), optics.Halo(0.1, 2.0), optics.Detector()])
    curves = []
    for name, u, v in (("across", freq, 0 * freq), ("along", 0 * freq, freq)):
        factor = 0.01 * np.hstack([np.eye(freq.size), 1j * np.eye(freq.size)])
        otf = np.asarray(sensor.otf(u, v), complex)
        curves.append(OtfSamples(name, u, v, otf, factor).centred())
    data = WhitenedCurves(curves)
    forms = [SensorForm(terms) for terms in FORMS[:6]]
    starts = likely_starts(data, forms)
    nowhere = np.zeros((data.values.size, 0))
    pairs = [(form, p) for form, own in zip(forms, starts, strict=True) for p in own]
    together = fit_forms(data, pairs, 0.0, nowhere)
    assert [one.form for one in together] == forms
    for one, form, own in zip(together, forms, starts, strict=True):
        (by_itself,) = fit_forms(data, [(form, p) for p in own], 0.0, nowhere)
        np.testing.assert_allclose(one.parameters, by_itself.parameters, atol=1e-5)
        assert one.score == pytest.approx(by_itself.score, abs=1e-5)
