"""The uncertainty budget: its terms add up, each is what it is called, and no copy loses it."""

import json
import math
import pickle
from functools import cache

import numpy as np
import pytest

import acutance as ac
from acutance.report import page, text
from acutance.targets.uncertainty_budget import (
    MAIN_NUMBERS,
    TERMS,
    budget_rows,
    least_systematic_share,
    std_of_mean,
    systematic_share,
)

SENSOR = ac.simulate.reference_systems()["diffraction"]
FITTED = ["pixel_noise", "prior_shape", "background", "line"]


def edge(snr=100.0, seed=1, method="spline", orientation="across", **options):
    rng = np.random.default_rng(seed)
    image, _ = ac.simulate.edge(
        SENSOR, angle_deg=6, orientation=orientation, shape=(40, 40), snr=snr, rng=rng
    )
    return ac.measure_edge(image, gsd_m=0.5, method=method, options=ac.EdgeOptions(**options))


def pulse(**arguments):
    rng = np.random.default_rng(2)
    image, _ = ac.simulate.pulse(SENSOR, width_px=3, angle_deg=6, snr=100, rng=rng)
    return ac.measure_pulse(image, width_px=3, **arguments)


@cache
def star():
    rng = np.random.default_rng(6)
    image, _ = ac.simulate.star(SENSOR, snr=80, shape=(96, 96), radius_px=40, rng=rng)
    return ac.measure_star(image)


@cache
def combined():
    return ac.combine([edge(), edge(orientation="along")])


STATED = {"target_softness_px": ac.Estimate(0.15, 0.05), "level_uncertainty": 0.005}
MEASUREMENTS = {
    "edge": edge,
    "stated": lambda: edge(**STATED),
    "published": lambda: edge(method="fermi", **STATED),
    "pulse": pulse,
    "star": star,
    "combined": combined,
}


@pytest.fixture(scope="module", params=MEASUREMENTS)
def measured(request):
    return MEASUREMENTS[request.param]()


def test_the_terms_add_up_to_the_variance(measured):
    for direction in measured.measured_directions:
        terms = [term for term in measured.budget if term.direction == direction]
        numbers = measured.directions[direction]
        for name in MAIN_NUMBERS:
            total = math.sqrt(sum(term.std[name] ** 2 for term in terms))
            assert total == pytest.approx(getattr(numbers, name).std, rel=1e-6)
            assert sum(term.share[name] for term in terms) == pytest.approx(1)


def test_every_term_has_its_words_and_no_copy_loses_it(measured):
    assert all(term.name in TERMS for term in measured.budget)
    again = pickle.loads(pickle.dumps(measured)).budget
    for copied, term in zip(again, measured.budget, strict=True):
        assert (copied.direction, copied.name) == (term.direction, term.name)
        assert copied.std == pytest.approx(term.std, rel=1e-9)
    light = pickle.loads(pickle.dumps(measured.without_details()))
    record = ac.Record.from_dict(json.loads(json.dumps(measured.to_dict())))
    assert light.budget == record.budget
    for written, term in zip(record.budget, measured.budget, strict=True):
        assert (written.direction, written.name) == (term.direction, term.name)
        assert written.std == pytest.approx(term.std, rel=1e-3)


def test_the_terms_are_those_of_the_kind():
    assert [term.name for term in edge().budget] == FITTED
    assert [term.name for term in edge(**STATED).budget][-2:] == [
        "target_softness",
        "level_uncertainty",
    ]
    free, held = ([term.name for term in pulse(fit_width=fit).budget] for fit in (True, False))
    assert set(free) == {*FITTED, "pulse_width", "halo"}
    assert set(held) == {*FITTED, "halo"}
    assert [term.name for term in edge(method="fermi").budget] == ["row_scatter"]
    assert {term.name for term in combined().budget} == {"fit"}
    assert len(star().budget) == 2


def test_the_noise_term_is_the_scatter_of_repeated_noise():
    """The same edge in other noise scatters by the terms of noise, not by that of the prior.

    Background and line are fitted to the same noise, so they scatter too.
    """
    found = [edge(snr=60.0, seed=seed) for seed in range(120)]
    for name in ("mtf_nyquist", "fwhm_px"):
        scatter = np.std([getattr(m, name).value for m in found])
        by_noise, total = (
            np.sqrt(np.mean([
                sum(term.std[name] ** 2 for term in m.budget if term.name in terms) for m in found
            ]))
            for terms in (("pixel_noise", "background", "line"), TERMS)
        )  # fmt: skip
        assert 0.8 < scatter / by_noise < 1.15, name
        assert scatter < 0.99 * total, name


def test_noise_shrinks_with_the_signal_but_a_statement_does_not():
    def std(term, m):
        return next(one.std["mtf_nyquist"] for one in m.budget if one.name == term)

    weak, strong = edge(snr=50.0, **STATED), edge(snr=500.0, **STATED)
    assert std("pixel_noise", weak) > 4 * std("pixel_noise", strong)
    assert std("target_softness", weak) == pytest.approx(std("target_softness", strong), rel=0.2)


def test_what_is_common_does_not_average_out():
    std, weight = np.full(4, 0.01), np.full(4, 0.25)
    assert std_of_mean(weight, std, np.zeros(4)) == pytest.approx(0.005)
    assert std_of_mean(weight, std, np.ones(4)) == pytest.approx(0.01)
    assert std_of_mean(weight, std, np.ones(4), widened=3.0) == pytest.approx(0.01)
    assert std_of_mean(weight, std, np.zeros(4), widened=3.0) == pytest.approx(0.015)


def test_the_common_part_is_that_of_prior_and_statements():
    m = edge(**STATED)
    terms = {term.name: term.share["rer"] for term in m.budget}
    common = terms["prior_shape"] + terms["target_softness"] + terms["level_uncertainty"]
    assert systematic_share(m.budget, "across", "rer") == pytest.approx(common)
    assert systematic_share(m.budget, "along", "rer") == 0
    others = [systematic_share(m.budget, "across", name) for name in ("rer", "mtf_nyquist")]
    assert systematic_share(m.budget, "across", "mtf50_cpp") >= max(others)


def test_a_number_that_does_not_exist_says_nothing_of_the_others():
    """A curve that does not fall to its half has no FWHM, and its budget none of it."""
    rows = budget_rows("across", {
        "pixel_noise": {"mtf_nyquist": 0.03, "rer": 0.02, "fwhm_px": math.nan},
        "prior_shape": {"mtf_nyquist": 0.01, "rer": 0.01, "fwhm_px": math.nan},
    })  # fmt: skip
    assert systematic_share(rows, "across", "mtf_nyquist") == pytest.approx(0.1)
    for name in ("mtf_area", "fwhm_px", "fwhm_m"):
        assert systematic_share(rows, "across", name) == pytest.approx(0.2)
        assert least_systematic_share(rows, "across", name) == pytest.approx(0.1)


def test_of_numbers_none_of_which_has_a_budget_all_is_common():
    nothing = dict.fromkeys(MAIN_NUMBERS, math.nan)
    rows = budget_rows("across", {"pixel_noise": nothing, "prior_shape": nothing})
    assert systematic_share(rows, "across", "rer") == 1
    assert systematic_share(rows, "along", "rer") == 0


def test_page_and_text_show_it():
    m = edge(**STATED)
    assert "Uncertainty budget" in page(m)
    assert "softness of the target" in page(m)
    assert "std of MTF at Nyquist: softness of the target's border" in text(m)
