"""Measurements combined: results or documents in, one 2-D OTF out."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.targets.combine.checks import check_combination
from acutance.targets.combine.curves import ChiSquare
from acutance.targets.combine.inputs import read_inputs
from acutance.targets.combine.sensor_forms import FORMS

SENSOR = optics.Sensor([optics.Gaussian(0.36, 0.48), optics.Detector()], gsd_m=0.7)


def gaussian(sigma_px):
    return optics.Sensor([optics.Gaussian(sigma_px), optics.Detector()])


def edge(angle, orientation, seed, sensor=SENSOR):
    image, _ = simulate.edge(
        sensor, angle_deg=angle, orientation=orientation, shape=(50, 50), dark=200, bright=1200,
        snr=100, rng=np.random.default_rng(seed),
    )  # fmt: skip
    return ac.measure_edge(image, gsd_m=0.7)


@pytest.fixture(scope="module")
def edges():
    return [edge(6, "across", 1), edge(7, "along", 2), edge(30, "across", 3)]


@pytest.fixture(scope="module")
def mirrors():
    image, _ = simulate.points(SENSOR, snr=80, rng=np.random.default_rng(4))
    return ac.measure_points(image, gsd_m=0.7)


@pytest.fixture(scope="module")
def together(edges, mirrors):
    return ac.combine([*edges, mirrors], names=["a", "b", "c", "mirrors"])


def test_across_and_along_are_those_of_the_grid(together):
    for name, angle in (("across", 0.0), ("along", 90.0)):
        found, true = getattr(together, name), SENSOR.response_along(angle)
        for metric in ("mtf_nyquist", "rer", "fwhm_px"):
            number = getattr(found, metric)
            assert abs(number.value - getattr(true, metric).value) < 3.5 * number.std
            assert number.std < 0.02


def test_the_combination_is_more_exact_than_any_of_its_parts(together, edges, mirrors):
    stds = [edges[0].mtf_nyquist.std, mirrors.across.mtf_nyquist.std]
    assert together.across.mtf_nyquist.std < min(stds)
    assert together.trusted, together.failed_checks


def test_parts_stand_beside_the_combination_and_its_deviation(together):
    for part in together.parts:
        for row, angle in enumerate(part.normal_deg):
            combined = together.mtf_at(angle)(part.freq_cpp)
            assert part.fitted[row] == pytest.approx(combined.value, abs=2e-3)
            assert part.fitted_std[row] == pytest.approx(combined.std, rel=0.1, abs=1e-4)


HALO = optics.Sensor([optics.Gaussian(0.4), optics.Halo(0.1, 2.5), optics.Detector()])


def scatter_over_std(sensor, draws, seed):
    """Errors over stated deviations of combinations of four edges, across and along."""
    options = ac.CombineOptions(forms=FORMS[:3])
    tilts = ((6.0, "across"), (7.0, "along"), (30.0, "across"), (-28.0, "along"))
    z = []
    for draw in range(draws):
        rng = np.random.default_rng((seed, draw))
        images = [
            simulate.edge(
                sensor, angle_deg=tilt + rng.uniform(-1.5, 1.5), orientation=way, shape=(50, 50),
                dark=200, bright=1200, snr=80, rng=rng,
            )[0]
            for tilt, way in tilts
        ]  # fmt: skip
        found = ac.combine([ac.measure_edge(image) for image in images], options=options)
        for own, angle in ((found.across, 0.0), (found.along, 90.0)):
            true = sensor.response_along(angle)
            for read in (
                lambda one: one.mtf_nyquist, lambda one: one.mtf(0.25), lambda one: one.rer,
                lambda one: one.fwhm_px,
            ):  # fmt: skip
                number = read(own)
                z.append((number.value - read(true).value) / number.std)
    return np.array(z)


def test_stated_deviations_are_those_of_measured_edges():
    """It is 1.02 for an elliptical blur and a halo; with deviations 0.8 or 1.25 times those stated
    it would be 1.27 or .82."""
    z = np.concatenate([scatter_over_std(SENSOR, 20, 17), scatter_over_std(HALO, 20, 18)])
    assert 0.84 < np.sqrt(np.mean(z**2)) < 1.13


def test_parameters_have_standard_deviations(together):
    for name, true in (("sigma_across_px", 0.36), ("sigma_along_px", 0.48)):
        number = together.parameters[name]
        assert 0 < number.std < 0.05
        assert abs(number.value - true) < 4 * number.std + 0.02


def test_documents_say_the_same_as_results(together, edges, mirrors):
    documents = [json.loads(json.dumps(one.to_dict())) for one in (*edges, mirrors)]
    again = ac.combine(documents, names=["a", "b", "c", "mirrors"])
    for name in ("across", "along"):
        old, new = (getattr(one, name).mtf_nyquist for one in (together, again))
        assert new.value == pytest.approx(old.value, abs=1e-3)
        assert new.std == pytest.approx(old.std, rel=0.05)


def test_a_document_without_covariance_is_used_and_said_so(edges):
    documents = [one.to_dict() for one in edges]
    del documents[0]["plane"]
    found = ac.combine(documents)
    messages = {check.name: check.message for check in found.checks}
    assert [check.name for check in found.failed_checks] == ["assumed_covariance"]
    assert messages["assumed_covariance"].startswith("1 measurement without covariance: ")
    assert messages["shared_targets"] == (
        "no pairs of the same pixels; 3 measurements are of arrays in memory, which are not "
        "compared"
    )
    assert abs(found.across.mtf_nyquist.value - SENSOR.mtf()(0.5).value) < 0.03


def test_two_directions_leave_the_rotation_to_the_prior(edges):
    found = ac.combine(edges[:2])
    assert "directions" in [check.name for check in found.failed_checks]


def test_another_sensor_among_them_is_named():
    parts = [edge(6, "across", 1), edge(7, "along", 2), edge(9, "across", 5, gaussian(0.6))]
    found = ac.combine(parts, names=["tarp", "roof", "road"])
    failed = {check.name: check for check in found.failed_checks}
    assert {"agreement", "worst_member"} <= set(failed)
    assert found.birge_ratio > 2
    assert "widened by the Birge ratio" in failed["agreement"].message


def test_sensors_that_only_a_large_correction_would_join_are_no_sensor():
    sharper, softer = gaussian(0.4), gaussian(0.5)
    kinds = ((6, "across", 1, sharper), (8, "across", 2, softer), (6, "along", 3, sharper))
    found = ac.combine([edge(*one) for one in kinds])
    assert found.sensor.correction_share > 0.1
    assert found.verdict.word == "invalid"
    assert "not of one sensor" in found.verdict.sentence


def test_sensors_far_apart_have_their_combination_between_them():
    """About each one's light to first order, nothing at all explained them best."""
    sharper, softer = gaussian(0.4), gaussian(0.75)
    kinds = ((6, "across", 1, softer), (6, "across", 2, sharper), (8, "along", 3, softer))
    found = ac.combine([edge(*one) for one in kinds])
    assert found.verdict.word == "invalid"
    assert found.chi_square.p_value < 1e-6
    correction = next(check for check in found.checks if check.name == "correction")
    assert "fits least, p = " in correction.message
    (beyond,) = (check for check in found.checks if check.name == "beyond_members")
    assert beyond.passed
    one, other, _ = found.parts
    middle = (one.freq_cpp >= 0.1) & (one.freq_cpp <= 0.4)
    assert np.all((one.value < one.fitted)[:, middle] & (other.fitted < other.value)[:, middle])


def test_a_combination_beyond_all_its_members_is_of_no_sensor(together, edges, mirrors):
    inputs = read_inputs([*edges, mirrors])

    def beyond(changes):
        parts = [
            replace(one, fitted=one.fitted + change)
            for one, change in zip(together.parts, changes, strict=True)
        ]
        checks = check_combination(inputs, together.details, parts, {})
        return next(check for check in checks if check.name == "beyond_members")

    count = len(together.parts)
    for side, word in ((-0.1, "below"), (0.1, "above")):
        found = beyond([side] * count)
        assert not found.passed
        assert found.severity == "fail"
        assert 0.02 < found.value < 0.1
        assert word in found.message
    assert beyond([-0.1, *(count - 1) * [0.1]]).passed


def test_of_measurements_without_any_chance_the_one_farthest_off_fits_least():
    """Chances of two were 0: the first of them was named, as if all others contradicted it."""
    sharpened, wide = (simulate.reference_systems()[name] for name in ("sharpened", "wide"))
    four = [
        edge(6, "across", 1, sharpened), edge(7, "along", 2, sharpened),
        edge(32, "across", 3, sharpened), edge(32, "across", 4, wide),
    ]  # fmt: skip
    forms = (("gaussian",), ("gaussian", "sharpening"))
    found = ac.combine(four, names=["a", "b", "c", "wide"], options=ac.CombineOptions(forms=forms))
    assert sum(part.chi_square.p_value == 0 for part in found.parts) > 1
    (worst,) = (check for check in found.checks if check.name == "worst_member")
    assert worst.message.startswith("wide fits least")


def test_members_that_agree_have_the_combination_between_them(together):
    (beyond,) = (check for check in together.checks if check.name == "beyond_members")
    assert beyond.value < 0.001


@pytest.mark.parametrize(("severity", "counted"), [("note", 0), ("caution", 1), ("fail", 1)])
def test_notes_of_a_member_only_widened_its_deviations(edges, severity, counted):
    documents = [one.to_dict() for one in edges]
    documents[0]["checks"][0] |= {"passed": False, "severity": severity}
    found = ac.combine(documents)
    (failed,) = (check for check in found.checks if check.name == "failed_inputs")
    assert failed.value == counted


def test_limits_can_be_changed(edges):
    options = ac.CombineOptions(limits={"directions": 2})
    assert ac.combine(edges[:2], options=options).trusted


def test_the_document_keeps_what_was_combined(together):
    document = together.to_dict()
    assert document["kind"] == "combined"
    assert [part["name"] for part in document["parts"]] == ["a", "b", "c", "mirrors"]
    assert document["sensor"]["parameters"]["sigma_across_px"]["std"] > 0
    assert sum(form["weight"] for form in document["forms"]) == pytest.approx(1)


def _without_deviations(plane):
    for part in ("factor_real", "factor_imag"):
        plane[part] = [[] for _ in plane[part]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d[0].update(schema="acutance/truth/1"), "acutance/truth/1, no measurement"),
        (lambda d: d[0].update(schema="other"), "no measurement of acutance"),
        (lambda d: d[0].pop("image"), "^one: the document lacks image: it was cut or changed"),
        (
            lambda d: d[0]["image"].update(band="two"),
            "^one: the document cannot be read as a measurement .the image of a measurement",
        ),
        (lambda d: d[0].update(plane={"normal_deg": [0]}), "cannot be read"),
        (lambda d: d[0]["plane"]["otf_real"].pop(), "cannot be read"),
        (lambda d: d[0]["plane"].update(normal_deg=[float("nan")]), "not finite"),
        (lambda d: d[0]["plane"].update(otf_real=[50.0] * 16), "near 1"),
        (lambda d: _without_deviations(d[0]["plane"]), "no standard deviations"),
        (lambda d: d[0]["image"].update(pixel_gsd_m=[2.8, 2.8]), "different pixels"),
        (lambda d: d[0]["image"].update(along_track="x"), "with the same axis along track"),
        (
            lambda d: (
                d[0]["image"].update(band=3, band_name="red", path="p.tif")
                or d[1]["image"].update(band=1, path="./p.tif")
            ),
            r"one is of band 3 \(red\) and two of band 1 of ./p.tif: each band has an MTF",
        ),
        (lambda d: d[0].update(kind="combined"), "a combination already"),
        (
            lambda d: d[0].update(kind="biresolution", options={"reference_given": False}),
            "the ratio MTF_low / MTF_high",
        ),
        (lambda d: d.append(copy.deepcopy(d[0])), "the same measurement"),
        (lambda d: d.__delitem__(slice(1, None)), "only one was given, one direction"),
        (lambda d: d.clear(), "nothing to combine"),
        (lambda d: d.__setitem__(0, {"schema": "acutance/comparison/1"}), "several methods"),
        (
            lambda d: d.__setitem__(0, {"schema": "acutance/bands/1"}),
            "that of one .--band N --json",
        ),
        (lambda d: d.__setitem__(0, 5), "is a int: give results"),
    ],
)
def test_what_does_not_belong_together_is_refused(edges, change, message):
    documents = [copy.deepcopy(one.to_dict()) for one in edges[:2]]
    change(documents)
    names = ["one", "two", "three"][: len(documents)]
    with pytest.raises(ac.OptionError, match=message):
        ac.combine(documents, names=names)


def test_one_direction_alone_is_refused(edges):
    with pytest.raises(ac.OptionError, match="show one direction"):
        ac.combine([edges[0], edge(9, "across", 8)])


def test_square_pixels_can_be_denied(edges):
    documents = [copy.deepcopy(one.to_dict()) for one in edges]
    documents[1]["image"]["pixel_gsd_m"] = [1.0, 0.7]
    found = ac.combine(documents, gsd_m=ac.Gsd(1.0, 0.7))
    assert found.along.gsd_m == pytest.approx(1.0)
    assert found.across.gsd_m == pytest.approx(0.7)


def _edge_of_pixels(gsd, seed, angle=6, orientation="across"):
    image, _ = simulate.edge(
        SENSOR, angle_deg=angle, orientation=orientation, shape=(50, 50), dark=200, bright=1200,
        snr=100, rng=np.random.default_rng(seed),
    )  # fmt: skip
    return ac.measure_edge(image, gsd_m=gsd)


def test_pixels_that_are_not_square_are_known_from_the_measurements():
    wide = ac.Gsd(0.5, 0.7)
    both = [_edge_of_pixels(wide, 1), _edge_of_pixels(wide, 2, 7, "along")]
    found = ac.combine(both)
    assert found.across.gsd_m == pytest.approx(0.7)
    assert found.along.gsd_m == pytest.approx(0.5)


@pytest.mark.parametrize("orientation", ["across", "along"])
def test_square_and_other_pixels_are_told_apart_in_any_direction(orientation):
    other = "along" if orientation == "across" else "across"
    square = _edge_of_pixels(0.5, 1, 6, other)
    wide = _edge_of_pixels(ac.Gsd(0.5, 0.7), 2, 7, orientation)
    with pytest.raises(ac.OptionError, match=r"0\.5 m, .* 0\.5 x 0\.7 m"):
        ac.combine([square, wide])
    # A document that holds one GSD alone is one of square pixels.
    old = copy.deepcopy(wide.to_dict())
    del old["image"]["pixel_gsd_m"]
    old["image"]["gsd_m"] = 0.7
    with pytest.raises(ac.OptionError, match="different pixels"):
        ac.combine([square, old])


def test_a_gsd_that_some_lack_fails_a_check_that_names_them():
    known, unknown = _edge_of_pixels(2.0, 1), _edge_of_pixels(None, 2, 7, "along")
    found = ac.combine([known, unknown], names=["a", "b"])
    (check,) = (one for one in found.failed_checks if one.name == "unknown_gsd")
    assert check.message.startswith("1 measurement without a GSD: b")
    for given, gsd_m in (([known, unknown], 2.0), ([_edge_of_pixels(None, 1), unknown], None)):
        stated = ac.combine(given, gsd_m=gsd_m)
        assert "unknown_gsd" not in [one.name for one in stated.failed_checks]


def test_a_target_document_is_taken_apart(edges):
    target = {"schema": "acutance/target/1", "measurements": [one.to_dict() for one in edges]}
    found = ac.combine([target], names=["tarp.json"])
    assert [part.name for part in found.parts] == [
        "tarp.json 1",
        "tarp.json 2",
        "tarp.json 3",
    ]


def test_combinations_of_points_hold_the_truth():
    """Four images of one sensor share a prior: counted four times, RER is off by four deviations.

    Halos are where the prior matters most: pixels show little of them.
    """
    z = []
    for draw in range(3):
        rng = np.random.default_rng((21, draw))
        halo = optics.Halo(0.05, rng.uniform(1.5, 4.0))
        sensor = optics.Sensor([optics.Gaussian(0.4), halo, optics.Detector()])
        found = []
        for _ in range(4):
            layout = simulate.mirror_columns((12.0, 12.0), count=5) + rng.uniform(0, 1, (1, 2))
            image, _ = simulate.points(sensor, positions=layout, snr=100, rng=rng)
            found.append(ac.measure_points(image, positions=layout))
        together = ac.combine(found, options=ac.CombineOptions(forms=FORMS[:3]))
        for own, angle in ((together.across, 0.0), (together.along, 90.0)):
            true = sensor.response_along(angle)
            assert own.mtf_nyquist.std < 1.2 * found[0].response_at(angle).mtf_nyquist.std
            for number, wanted in (
                (own.mtf_nyquist, true.mtf_nyquist), (own.mtf(0.25), true.mtf(0.25)),
                (own.rer, true.rer),
            ):  # fmt: skip
                z.append((number.value - wanted.value) / number.std)
    assert np.mean(np.abs(z) < 1.96) >= 0.85
    assert np.sqrt(np.mean(np.square(z))) < 1.5


def test_a_part_that_tells_nothing_leaves_the_document_strict(together):
    mute = replace(together.parts[0], chi_square=ChiSquare(0.0, 0.0, 0.0))
    document = mute.to_dict()
    assert document["p_value"] is None
    json.dumps(document, allow_nan=False)


def test_a_gsd_that_is_stated_makes_no_product_of_two():
    half, one = _edge_of_pixels(0.5, 1, 6, "across"), _edge_of_pixels(1.0, 2, 7, "along")
    with pytest.raises(ac.OptionError, match=r"different pixels: .* 0\.5 m, .* 1 m, which"):
        ac.combine([half, one], gsd_m=1.0)
    # Each states the distance along its own normal alone: pixels that are not square.
    oblong = ac.combine([half, one], gsd_m=ac.Gsd(1.0, 0.5))
    assert oblong.across.fwhm_m.value == pytest.approx(half.fwhm_m.value, rel=0.02)
    # Another GSD for both, as where the one of their files is wrong.
    same = _edge_of_pixels(0.5, 2, 7, "along")
    assert ac.combine([half, same], gsd_m=0.7).across.fwhm_m is not None


def test_one_file_by_two_names_is_one_file(tmp_path, monkeypatch):
    image, _ = simulate.edge(SENSOR, angle_deg=6, snr=100, rng=np.random.default_rng(1))
    np.save(tmp_path / "e.npy", image)
    monkeypatch.chdir(tmp_path)
    names = "e.npy", str(tmp_path / "e.npy")
    found = [
        ac.measure_edge(ac.open_image(name), method=method).to_dict()
        for name, method in zip(names, ("spline", "fermi"), strict=True)
    ]
    other = edge(7, "along", 2)
    checks = {check.name: check.value for check in ac.combine([*found, other]).checks}
    assert checks["shared_targets"] == 1
