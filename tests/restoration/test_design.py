"""From measurements to a filter: knobs, deviations, documents, refusals."""

import copy
import json

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Otf2d
from acutance.restoration.filtered_otf import FilteredOtf, SensorOtf
from acutance.restoration.knobs import worst_overshoot


def test_each_knob_is_met_and_the_others_are_told(sensor):
    by_gain = ac.design_restoration(sensor, snr=80, noise_gain=1.6, size=11)
    assert by_gain.noise_gain == pytest.approx(1.6, rel=1e-6)
    assert by_gain.noise_gain == pytest.approx(np.linalg.norm(by_gain.kernel))
    assert by_gain.snr_after == pytest.approx(50.0)
    by_mtf = ac.design_restoration(sensor, mtf_nyquist=0.3, size=11)
    both = (by_mtf.after.across.mtf_nyquist.value + by_mtf.after.along.mtf_nyquist.value) / 2
    assert both == pytest.approx(0.3, abs=1e-6)
    by_overshoot = ac.design_restoration(sensor, overshoot=0.035, size=11)
    assert by_overshoot.after.overshoot.value == pytest.approx(0.035, abs=1e-6)


def test_what_is_predicted_is_what_the_kernel_does(sensor, sharpening):
    """The prediction for the measured sensor, and the truth of the same kernel, within errors."""
    true = Otf2d(FilteredOtf(SensorOtf(sensor), sharpening.kernel))
    for name, angle in (("across", 0.0), ("along", 90.0)):
        after = sharpening.after.directions[name]
        response = true.response(angle)
        for number in ("mtf_nyquist", "rer", "fwhm_px", "overshoot"):
            told = after.numbers[number]
            assert abs(told.value - getattr(response, number).value) < 3 * told.std + 1e-4
        assert after.mtf_nyquist > sharpening.before.directions[name].mtf_nyquist


@pytest.mark.parametrize("knob", [{"noise_gain": 0.2}, {"mtf_nyquist": 0.01}, {"snr": 3}])
def test_a_kernel_that_blurs_is_noted(sensor, knob):
    filter = ac.design_restoration(sensor, **knob, size=11)
    (note,) = [one for one in filter.notes if "blurs" in one]
    for name in ("across", "along"):
        before, after = (one.directions[name] for one in (filter.before, filter.after))
        assert f"RER {name} falls from {before.rer.value:.3f} to {after.rer.value:.3f}" in note


def test_what_sharpens_or_was_asked_to_be_softer_has_no_note_of_blur(sensor, sharpening):
    softer = ac.Sensor([*sensor.blocks, ac.optics.Gaussian(0.5)])
    for filter in (sharpening, ac.design_restoration(sensor, target=softer, snr=80)):
        assert not [one for one in filter.notes if "blurs" in one]


def test_directions_are_not_swapped(sensor):
    """Smear along the rows' axis is undone along it: there the kernel amplifies more."""
    filter = ac.design_restoration(sensor, snr=80, noise_gain=1.8)
    assert filter.before.along.mtf_nyquist < filter.before.across.mtf_nyquist
    assert abs(filter.otf(0.0, 0.4)) > 1.05 * abs(filter.otf(0.4, 0.0))


def test_deviations_after_are_those_before_times_the_filter(edges, sharpening):
    both = ac.combine(edges)
    gain = abs(complex(sharpening.otf(0.5, 0.0)))
    before, after = both.across.mtf_nyquist, sharpening.after.across.mtf_nyquist
    assert after.std == pytest.approx(gain * before.std, rel=1e-3)
    assert after.value == pytest.approx(gain * before.value, rel=5e-3)


def test_an_overshoot_in_per_cent_is_asked_for_its_share(sensor):
    with pytest.raises(ac.OptionError, match=r"share of the contrast: was 0\.05 \(5 %\) meant\?"):
        ac.design_restoration(sensor, snr=100, overshoot=5, size=7)
    for knob in ({"overshoot": 0.9}, {"overshoot": 500.0}, {"mtf_nyquist": 5.0}):
        with pytest.raises(ac.OptionError) as caught:
            ac.design_restoration(sensor, snr=100, size=7, **knob)
        assert "meant" not in str(caught.value)


def test_a_deviation_of_overshoot_is_the_scatter_over_the_posterior(edges, sharpening):
    model = ac.combine(edges).otf.model
    response = Otf2d(FilteredOtf(model, sharpening.kernel)).response(0.0)
    factor = response.esf.covariance_factor
    rng = np.random.default_rng(5)
    z = rng.normal(size=(factor.shape[1], 2000))
    drawn = (response.esf.value[:, None] + factor @ z).max(axis=0) - 1
    ratio = sharpening.after.across.overshoot.std / drawn.std()
    assert 0.85 < ratio < 1.2


@pytest.mark.parametrize("off", [0.1, -0.1])
def test_an_mtf_that_is_off_by_its_deviation_does_not_ring_beyond_the_interval(sensor, off):
    true = SensorOtf(sensor)

    class Wrong:
        band_cpp = 4.0

        def reach(self, u, v):
            return 1 - np.exp(-(u**2 + v**2) / 0.15**2)

        def otf(self, u, v):
            return true.otf(u, v) * (1 + off * self.reach(u, v))

        def factor(self, u, v):
            return (0.1 * self.otf(u, v) * self.reach(u, v))[:, None]

    filter = ac.design_restoration(Otf2d(Wrong()), overshoot=0.03)
    restored = Otf2d(FilteredOtf(true, filter.kernel))
    found = worst_overshoot(tuple(restored.response(at) for at in (0.0, 90.0)))
    assert found < filter.after.overshoot.interval()[1]
    assert filter.after.overshoot.std > 0.002


def test_a_target_is_reached(sensor):
    wanted = ac.Sensor([ac.optics.Gaussian(0.35), ac.optics.Detector()])
    filter = ac.design_restoration(sensor, snr=200, target=wanted)
    assert filter.method == "target"
    for after in filter.after.directions.values():
        assert after.mtf_nyquist.value == pytest.approx(wanted.mtf()(0.5).value, abs=0.02)


def test_least_expected_error_depends_on_the_snr(sensor):
    gains = [ac.design_restoration(sensor, snr=snr, size=9).noise_gain for snr in (10, 50, 250)]
    assert gains == sorted(gains)
    assert gains[0] < 1 < gains[2]


def test_a_document_is_read_again_exactly(sharpening):
    document = json.loads(json.dumps(sharpening.to_dict()))
    again = ac.RestorationFilter.from_dict(document)
    assert again == sharpening
    assert again.to_dict() == sharpening.to_dict()
    assert np.array_equal(again.kernel, sharpening.kernel)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.update(schema="acutance/measurement/1"), "no document"),
        (lambda d: d.pop("after"), "lacks after"),
        (lambda d: d["kernel"].pop(), "square and odd"),
        (lambda d: d["kernel"][0].__setitem__(0, 5.0), "sum"),
        (lambda d: d["kernel"][0].__setitem__(0, None), "cannot be read"),
        (lambda d: d.update(noise_gain=7.0), "noise gain"),
        (lambda d: d["before"].pop("along"), "cannot be read"),
    ],
)
def test_a_damaged_document_is_refused(sharpening, change, message):
    document = copy.deepcopy(sharpening.to_dict())
    change(document)
    with pytest.raises(ac.OptionError, match=message):
        ac.RestorationFilter.from_dict(document)


def test_one_direction_is_refused_until_isotropy_is_stated(edges):
    with pytest.raises(ac.OptionError, match="one direction"):
        ac.design_restoration(edges[0], noise_gain=1.5)
    filter = ac.design_restoration(edges[0].to_dict(), noise_gain=1.5, isotropic=True)
    assert any("same blur in all directions" in note for note in filter.notes)
    across, along = filter.after.across.mtf_nyquist, filter.after.along.mtf_nyquist
    assert across.value == pytest.approx(along.value, rel=1e-5)


def test_a_record_in_two_dimensions_gives_what_the_measurement_does(edges):
    both = ac.combine(edges)
    whole = ac.design_restoration(both, noise_gain=1.8, snr=100, size=9)
    record = ac.design_restoration(both.record, noise_gain=1.8, snr=100, size=9)
    for name in ("across", "along"):
        one, other = (f.after.directions[name].mtf_nyquist for f in (whole, record))
        assert one.value == pytest.approx(other.value, abs=0.02)


def test_an_mtf_that_reaches_zero_is_told():
    blurred = ac.Sensor([ac.optics.Detector(), ac.optics.Smear(2.5, "along")])
    filter = ac.design_restoration(blurred, snr=100, size=11)
    assert any("along falls to" in note for note in filter.notes)
    assert np.isfinite(filter.kernel).all()
    assert filter.noise_gain < 5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"noise_gain": 2.0, "overshoot": 0.05}, "each of them determines"),
        ({"noise_gain": 50.0}, "reach 0.0[0-9] to"),
        ({"mtf_nyquist": 0.95}, r"choose a value between them, or the sharper aim"),
        ({"mtf_nyquist": 0.95, "desired": "point"}, "choose a value between them$"),
        ({"noise_gain": 0.01}, "choose a value between them$"),
        ({"overshoot": 3.0}, "reach"),
        ({"noise_gain": -1.0}, "above 0"),
        ({"noise_gain": float("nan")}, "finite"),
        ({"noise_gain": 1.5, "size": 8}, "odd"),
        ({"noise_gain": 1.5, "size": 99}, "odd number"),
        ({"noise_gain": 1.5, "method": "inverse"}, "one of wiener"),
        ({"method": "constrained"}, "knows no scene"),
        ({"noise_gain": 1.5, "method": "target"}, "go together"),
        ({}, "no SNR is known"),
        ({"noise_gain": 1.5, "snr": 0.0}, "snr is"),
        ({"noise_gain": 1.5, "scene": "moon"}, "scene is"),
        ({"noise_gain": 1.5, "scene": np.zeros((64, 64))}, r"of an array Image\.from_array"),
        ({"noise_gain": 1.5, "desired": "line"}, "desired is"),
    ],
)
def test_what_means_nothing_is_refused(sensor, arguments, message):
    with pytest.raises(ac.OptionError, match=message):
        ac.design_restoration(sensor, **arguments)


def test_something_that_is_no_sensor_is_refused():
    with pytest.raises(ac.OptionError, match="describes no sensor"):
        ac.design_restoration(np.ones(3), noise_gain=2)


def test_the_spectrum_of_a_scene_is_found_in_its_image(sensor):
    pixels, _ = ac.simulate.landscape(
        sensor, shape=(400, 400), snr=60, rng=np.random.default_rng(3)
    )
    truth, _ = ac.simulate.landscape(
        ac.Sensor([ac.optics.Detector()]), shape=(400, 400), rng=np.random.default_rng(3)
    )
    image = pixels.astype(float)

    def error(**how):
        filter = ac.design_restoration(sensor, snr=60, size=11, **how)
        return np.mean((ac.restore(image, filter) - truth)[20:-20, 20:-20] ** 2)

    own = error(scene=ac.Image.from_array(image))
    assert own < 0.85 * np.mean((image - truth)[20:-20, 20:-20] ** 2)
    for other in ("natural", ac.NaturalScene(4.0), ac.NaturalScene(200.0, 3.0)):
        assert own < error(scene=other)


def test_a_scene_without_room_for_a_spectrum_is_refused(sensor):
    with pytest.raises(ac.ImageError, match="windows"):
        ac.design_restoration(sensor, noise_gain=1.5, scene=ac.Image.from_array(np.ones((90, 90))))
