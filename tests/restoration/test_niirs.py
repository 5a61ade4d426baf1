"""The General Image Quality Equation: test vectors, guard rails, deviations."""

import math

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Otf2d
from acutance.report import niirs_text
from acutance.restoration.filtered_otf import FilteredOtf
from acutance.restoration.giqe import GiqeInputs, giqe
from acutance.restoration.known_otf import known_otf
from acutance.restoration.niirs_change import giqe_readings, niirs_changes


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"gsd_m": 0.52832, "rer": 0.35, "snr": 50, "version": 5}, 5.0152),
        ({"gsd_m": 0.7, "rer": (0.45, 0.42), "snr": 80, "elevation_deg": 70, "version": 5}, 4.6786),
        (
            {"gsd_m": 39.37 * 0.0254, "rer": 0.9, "snr": 50, "giqe_h": 1.3, "noise_gain": 10,
             "version": 4},
            3.9621,
        ),
    ],
)  # fmt: skip
def test_vectors(arguments, expected):
    assert ac.niirs(**arguments).value == pytest.approx(expected, abs=5e-5)


def test_version_3_is_the_equation_written_out():
    found = ac.niirs(gsd_m=1.0, rer=0.5, snr=40, giqe_h=1.2, noise_gain=2, version=3)
    inches = 1 / 0.0254
    expected = 11.81 + 3.32 * math.log10(0.5 / inches) - 1.48 * 1.2 - 2 / 40
    assert found.value == pytest.approx(expected)


def test_the_noise_term_of_version_4_is_344_thousandths():
    quiet, loud = (ac.niirs(gsd_m=1, rer=0.5, snr=snr, version=4).value for snr in (100, 10))
    assert quiet - loud == pytest.approx(0.344 * (1 / 10 - 1 / 100))


@pytest.mark.parametrize(("version", "power"), [(3, 0.5), (4, 0.5), (5, 0.25)])
def test_a_low_elevation_stretches_pixels_on_the_ground(version, power):
    high, low = (
        ac.niirs(gsd_m=1, rer=0.5, snr=50, elevation_deg=one, version=version).value
        for one in (90, 30)
    )
    by_gsd = 3.16 if version == 4 else 3.32
    assert high - low == pytest.approx(by_gsd * power * math.log10(2))


def test_the_smaller_rer_counts_twice_in_version_5():
    mixed = ac.niirs(gsd_m=1, rer=(0.6, 0.3), snr=20).value
    turned = ac.niirs(gsd_m=1, rer=(0.3, 0.6), snr=20).value
    mean = ac.niirs(gsd_m=1, rer=math.sqrt(0.18), snr=20).value
    assert mixed == turned
    assert mixed < mean


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"rer": 0.4, "snr": 4}, "low SNR"),
        ({"rer": 0.1, "snr": 50}, "RER out of range"),
        ({"rer": (0.5, 1.4), "snr": 50, "version": 4}, "RER out of range"),
        ({"rer": 0.9, "snr": 50, "version": 4}, "jump at RER 0.9"),
        ({"rer": ac.Estimate(0.86, 0.03), "snr": 50, "version": 4}, "jump at RER 0.9"),
        ({"rer": 0.6, "snr": 50, "noise_gain": 2.0}, "sharpened image"),
        ({"rer": 0.6, "snr": 50, "giqe_h": 1.2}, "overshoot H"),
        ({"rer": 0.5, "snr": 50, "gsd_m": 70}, "GSD out of range"),
        ({"rer": 0.5, "snr": 50, "gsd_m": 70}, "off the scale"),
        ({"rer": 0.5, "snr": 50, "elevation_deg": 12}, "low elevation"),
    ],
)
def test_guard_rails_are_notes_of_the_result(arguments, name):
    found = ac.niirs(**{"gsd_m": 0.7, **arguments})
    assert name in [note.name for note in found.notes]
    assert name in str(found)
    assert found.to_dict()["notes"][0]["message"]


def test_an_ordinary_image_has_no_note():
    for version in (3, 4, 5):
        found = ac.niirs(gsd_m=0.7, rer=0.45, snr=80, version=version)
        assert found.notes == ()
        assert str(found).endswith(f"(GIQE {version})")


def test_the_jump_of_version_4_is_told():
    low, high = (ac.niirs(gsd_m=0.7, rer=one, snr=50, version=4) for one in (0.89999999, 0.9))
    told = float(high.notes[0].message.split("by ")[1].replace("−", "-"))
    assert high.value - low.value == pytest.approx(told, abs=0.005)


def test_deviations_of_the_inputs_and_of_the_equation_add_in_squares():
    found = ac.niirs(
        gsd_m=0.7, rer=(ac.Estimate(0.45, 0.02), ac.Estimate(0.45, 0.02)), snr=50, version=3
    )
    slope = 3.32 / math.log(10) / 2 / 0.45
    assert found.inputs_std == pytest.approx(math.sqrt(2) * slope * 0.02, rel=1e-3)
    assert found.std == pytest.approx(math.hypot(found.inputs_std, 0.3))
    exact = ac.niirs(gsd_m=0.7, rer=0.45, snr=50)
    assert exact.inputs_std == 0
    assert exact.std == exact.equation_std


@pytest.mark.parametrize("snr", [5, 80])
def test_the_deviation_of_equal_rers_in_version_5_is_that_of_the_equation(snr):
    """Of equal RERs the smaller one is whichever is lowered; it counts twice on that side alone."""
    rer, std = 0.4, 0.01
    low, high = (ac.niirs(gsd_m=0.7, rer=rer + one, snr=snr).value for one in (-1e-5, 1e-5))
    one = ac.niirs(gsd_m=0.7, rer=ac.Estimate(rer, std), snr=snr)
    assert one.inputs_std == pytest.approx(std * (high - low) / 2e-5, rel=1e-3)
    two = ac.niirs(gsd_m=0.7, rer=(ac.Estimate(rer, std), ac.Estimate(rer, std)), snr=snr)
    drawn = rer + std * np.random.default_rng(1).normal(size=(2000, 2))
    scatter = np.std([ac.niirs(gsd_m=0.7, rer=tuple(both), snr=snr).value for both in drawn])
    assert two.inputs_std == pytest.approx(scatter, rel=0.06)


def test_the_jump_of_version_4_is_no_slope():
    stds = [
        ac.niirs(gsd_m=0.7, rer=ac.Estimate(rer, 0.01), snr=80, version=4).inputs_std
        for rer in (0.89999, 0.9, 0.90001)
    ]
    by_rer = [2.817, 1.559, 1.559]
    assert stds == pytest.approx([0.01 * one / math.log(10) / 0.9 for one in by_rer], rel=1e-3)


def test_a_measurement_gives_what_is_not_stated(edges):
    found = ac.niirs(edges[0], elevation_deg=80)
    assert found.inputs.rer_across == found.inputs.rer_along == edges[0].rer.value
    assert found.inputs.gsd_m == pytest.approx(0.7)
    assert found.inputs.snr == pytest.approx(edges[0].snr)
    assert found.inputs_std > 0
    assert ac.niirs(edges[0].record, snr=20).inputs.snr == 20
    assert "one direction" in [note.name for note in found.notes]
    both = ac.niirs(edges[0], rer=(edges[0].rer, edges[1].rer))
    assert "one direction" not in [note.name for note in both.notes]


def failed(edge, severity):
    """The document of an edge whose first two checks failed."""
    document = edge.to_dict()
    for check, message in zip(document["checks"], ("it is a mask", "it is bent"), strict=False):
        check |= {"passed": False, "severity": severity, "message": message}
        severity = "note"
    return document


@pytest.mark.parametrize(("severity", "word"), [("fail", "invalid"), ("caution", "doubtful")])
def test_the_verdict_of_a_measurement_is_told_and_the_number_kept(edges, severity, word):
    document = failed(edges[0], severity)
    found = ac.niirs(document)
    assert found.value == ac.niirs(edges[0]).value
    assert found.verdict == found.to_dict()["verdict"] == word
    note = found.notes[0]
    assert note.name == f"{word} measurement"
    assert note.message == f"it is a mask (failed too: {document['checks'][1]['name']})"
    assert f"{word} measurement" in str(found)
    assert str(ac.niirs(document, names=["a/mask.json"]).notes[0]).endswith(
        f"measurement: mask.json: {note.message}"
    )


def test_what_is_stated_has_no_verdict():
    assert ac.niirs(gsd_m=0.7, rer=0.45, snr=80).verdict is None


def test_measurements_of_two_directions_are_combined(edges):
    both = ac.combine(edges)
    found = ac.niirs([edges[0], failed(edges[1], "fail")], names=["across.json", "along.json"])
    assert found.inputs.rer_across == pytest.approx(both.across.rer.value)
    assert found.inputs.rer_along == pytest.approx(both.along.rer.value)
    assert found.inputs.snr == pytest.approx((edges[0].snr + edges[1].snr) / 2)
    assert found.verdict == "doubtful"
    names = [note.name for note in found.notes]
    assert names[:2] == ["invalid measurement", "combination"]
    assert "one direction" not in names
    assert "whose own checks failed" not in "".join(note.message for note in found.notes)


@pytest.mark.parametrize(("gsd_m", "own"), [(0.3, 0.7), ((0.7, 0.7), None), (None, None)])
def test_a_stated_gsd_has_that_of_the_measurement_beside_it(edges, gsd_m, own):
    found = ac.niirs(edges[0], gsd_m=gsd_m)
    assert found.measured_gsd_m == (None if own is None else pytest.approx(own))
    assert found.to_dict()["measured_gsd_m"] == found.measured_gsd_m
    assert ac.niirs(gsd_m=0.3, rer=0.5, snr=50).measured_gsd_m is None


def test_an_image_without_noise_has_a_number(edges):
    document = edges[0].to_dict() | {"snr": 7e14}
    assert ac.niirs(document).value == pytest.approx(ac.niirs(edges[0], snr=1e9).value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"rer": 0.5, "snr": 50}, "gsd_m"),
        ({"gsd_m": 0.7, "snr": 50}, "RER"),
        ({"gsd_m": 0.7, "rer": 0.5}, "SNR"),
        ({"gsd_m": 0.7, "rer": -0.5, "snr": 50}, "from 0.001 to 2"),
        ({"gsd_m": 0.7, "rer": 5, "snr": 50}, "rer_across is 5"),
        ({"gsd_m": -0.7, "rer": 0.5, "snr": 50}, "gsd_m is -0.7"),
        ({"gsd_m": (-1, -1), "rer": 0.5, "snr": 50}, "gsd_m is -1"),
        ({"gsd_m": (1, -1), "rer": 0.5, "snr": 50}, "gsd_m is -1"),
        ({"gsd_m": math.nan, "rer": 0.5, "snr": 50}, "gsd_m is nan"),
        ({"gsd_m": (1, 1, 1), "rer": 0.5, "snr": 50}, "3 values"),
        ({"gsd_m": 0.7, "rer": 1e308, "snr": 50}, "rer_across"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": math.inf}, "snr is inf"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": 50, "elevation_deg": "low"}, "give a number"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": 50, "noise_gain": math.nan}, "noise_gain"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": 50, "giqe_h": -1}, "giqe_h"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": "high"}, "give a number"),
        ({"gsd_m": 0.7, "rer": (0.5, 0.4, 0.3), "snr": 50}, "3 values"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": 50, "version": 2}, "versions 3, 4 and 5"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": 50, "elevation_deg": 1.2}, "from 5 to 90"),
        ({"gsd_m": 0.7, "rer": 0.5, "snr": 50, "noise_gain": 0}, "noise_gain"),
    ],
)
def test_what_is_missing_or_no_number_is_refused(arguments, message):
    with pytest.raises(ac.OptionError, match=message):
        ac.niirs(**arguments)


def test_a_change_has_the_sign_of_the_numbers_it_is_made_of(sharpening):
    change = sharpening.niirs_change
    assert set(change) == {3, 4, 5}
    before, after = sharpening.before, sharpening.after

    def mean(sharpness, name):
        numbers = (one.numbers[name].value for one in sharpness.directions.values())
        return math.prod(numbers) ** 0.5

    expected = 2.817 * math.log10(mean(after, "rer") / mean(before, "rer"))
    expected -= 0.656 * (mean(after, "giqe_h") - mean(before, "giqe_h"))
    expected -= 0.344 * (sharpening.noise_gain - 1) / sharpening.snr
    assert change[4].value == pytest.approx(expected, abs=1e-3)
    assert 0 < change[4].std < 0.1


def test_a_change_has_the_deviation_of_an_rer_that_both_directions_share(edges):
    """Slopes to one side count the lower RER of GIQE 5 alone: 2/3 of the deviation."""
    kernel = np.array([[0, -0.1, 0], [-0.1, 1.4, -0.1], [0, -0.1, 0]])
    gain = float(np.linalg.norm(kernel))
    known = known_otf(edges[0], isotropic=True).otf
    before = [known.response(angle) for angle in (0.0, 90.0)]
    restored = Otf2d(FilteredOtf(known.model, kernel), known.gsd_m)
    after = [restored.response(angle) for angle in (0.0, 90.0)]
    (rer, *_), (row, *_) = giqe_readings(before)
    (new_rer, *_), (new_row, *_) = giqe_readings(after)

    def slope(rer, snr):
        above, below = (giqe(GiqeInputs(1.0, one, one, snr), 5) for one in (rer + 1e-4, rer - 1e-4))
        return (above - below) / 2e-4

    true = np.linalg.norm(slope(new_rer, 80 / gain) * new_row - slope(rer, 80) * row)
    assert niirs_changes(before, after, 80, gain)[5].std == pytest.approx(true, rel=0.01)


def test_the_ratio_of_two_sensors_has_no_niirs():
    """Of two resolutions without the MTF of the finer one the curves are no sensor's own."""
    sensor = ac.simulate.reference_systems()["gaussian"]
    low, high, _ = ac.simulate.pair(
        sensor, sensor, ratio=4, shape=(64, 64), snr=200, rng=np.random.default_rng(1)
    )
    found = ac.measure_biresolution(low, high, ratio=4)
    for given in (found, found.record, found.to_dict(), [found, found.record]):
        with pytest.raises(ac.OptionError, match=r"is the ratio MTF_low / MTF_high.*--reference"):
            ac.niirs(given, gsd_m=10.0, snr=80)


def test_a_stated_rer_and_snr_have_those_of_the_measurement_beside_them(edges):
    plain, stated = ac.niirs(edges[0]), ac.niirs(edges[0], rer=0.5, snr=10)
    own = plain.inputs
    assert stated.measured_rer == (own.rer_across, own.rer_along)
    assert stated.measured_snr == own.snr
    assert stated.to_dict()["measured_rer"] == [own.rer_across, own.rer_along]
    told = niirs_text(stated)
    assert f"0.5000, 0.5000 (stated; measured {own.rer_across:.4f}, {own.rer_along:.4f})" in told
    assert "10 (stated; measured " in told
    assert (plain.measured_rer, plain.measured_snr) == (None, None)
    assert ac.niirs(edges[0], rer=(own.rer_across, own.rer_along)).measured_rer is None
    alone = ac.niirs(gsd_m=0.3, rer=0.5, snr=50)
    assert alone.measured_rer is None
    assert "of the inputs" in niirs_text(alone)
