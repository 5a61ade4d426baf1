"""The reference of a pair: what may be given, what is read of it, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pair_scenes import REFERENCE, SMALL, measured, rendered

import acutance as ac
from acutance.geometry.line import Orientation
from acutance.raster import Gsd
from acutance.targets import EdgeGroup, Record, TargetResult
from acutance.targets.pair import MeasuredCurves, measured_reference
from acutance.targets.pair.reference import known_curves


def test_document_as_a_reference() -> None:
    curves = measured_reference(measured(shape=SMALL).to_dict(), "file")
    assert curves.across(0.5).value == pytest.approx(
        measured(shape=SMALL).across.mtf_nyquist.value, abs=1e-5
    )


@cache
def edge_of_the_reference(
    gsd_m: float | None = None, orientation: Orientation = "across"
) -> ac.Measurement:
    image, _ = ac.simulate.edge(
        REFERENCE, angle_deg=6, orientation=orientation, snr=100, rng=np.random.default_rng(3)
    )
    return ac.measure_edge(image, gsd_m=gsd_m)


def test_a_reference_in_one_direction_fails_a_check() -> None:
    low, high, _ = rendered(shape=SMALL)
    image = ac.Image.from_array(high, gsd_m=10.0)
    edge = edge_of_the_reference(10.0)
    for reference in (edge, measured_reference(edge.to_dict(), "edge.json")):
        m = ac.measure_biresolution(low, image, reference_mtf=reference)
        (check,) = (one for one in m.failed_checks if one.name == "reference_directions")
        assert f"{edge.line.normal_deg:.1f} degrees from the column axis" in check.message
    names = {check.name for check in measured(shape=SMALL).checks}
    assert "reference_directions" not in names


def test_a_reference_of_other_pixels_is_refused() -> None:
    low, high, _ = rendered(shape=SMALL)
    wrong = edge_of_the_reference(0.7)
    message = r"pixels of 0.7 m, those of the high image have 10 m"
    for pair in ((low, ac.Image.from_array(high, 10.0)), (ac.Image.from_array(low, 20.0), high)):
        with pytest.raises(ac.OptionError, match=message):
            ac.measure_biresolution(*pair, reference_mtf=wrong)
    with pytest.raises(ac.OptionError, match=message):
        ac.measure_biresolution(
            low, ac.Image.from_array(high, 10.0),
            reference_mtf=measured_reference(wrong.to_dict(), "edge.json"),
        )  # fmt: skip


def test_a_ratio_is_no_reference() -> None:
    low, high, _ = rendered(shape=SMALL)
    ratio = ac.measure_biresolution(low, high)
    with pytest.raises(ac.OptionError, match="no sensor's own MTF"):
        measured_reference(ratio.to_dict(), "file")


def test_documents_that_are_no_measurement() -> None:
    for document in ([], {}, {"schema": "acutance/measurement/1"}):
        with pytest.raises(ac.OptionError):
            measured_reference(document, "file")


def test_reference_uncertainty_enters() -> None:
    low, high, _ = rendered(shape=SMALL)
    freq = np.linspace(0, 1, 101)
    curve = ac.Mtf(
        freq,
        np.abs(REFERENCE.otf(freq, 0.0)).astype(complex),
        np.full((101, 1), 0.03 + 0j) * (freq > 0)[:, None],
    )
    m = ac.measure_biresolution(low, high, reference_mtf=MeasuredCurves(curve, curve))
    expected = measured(shape=SMALL).across.mtf_nyquist
    assert m.across.mtf_nyquist.value == pytest.approx(expected.value, rel=0.01)
    assert m.across.mtf_nyquist.std > expected.std
    number = ac.measure_biresolution(low, high, reference_mtf=0.2891)
    assert number.across.mtf_nyquist.value == pytest.approx(expected.value, rel=1e-3)


def test_a_record_and_the_edges_of_a_target_are_references_too() -> None:
    across, along = edge_of_the_reference(), edge_of_the_reference(orientation="along")
    assert (across.orientation, along.orientation) == ("across", "along")
    groups = {one.orientation: EdgeGroup(one.orientation, (one,), {}, {}, {}, 0)
              for one in (along, across)}  # fmt: skip
    found = known_curves(TargetResult((along, across), (), groups))
    assert found is not None
    assert found.only_direction is None
    for edge, curve in ((across, found.across), (along, found.along)):
        assert curve.value == pytest.approx(edge.mtf.value)
        assert curve.std == pytest.approx(edge.mtf.std)
        read = known_curves(edge.record)
        assert read is not None
        assert read.across(0.5).value == pytest.approx(edge.mtf_nyquist.value, abs=1e-5)
        assert read.normal_deg == pytest.approx(edge.normal_deg)


def test_no_edge_is_no_reference() -> None:
    with pytest.raises(ac.OptionError, match="no edge was measured"):
        known_curves(TargetResult((), (), {}))


def test_axes_of_the_pixels_and_not_of_the_track() -> None:
    """A reference flown along its rows: across track is down the columns."""
    m = measured("trail", shape=SMALL)
    flown = replace(m, image=replace(m.image, along_track="x"))
    for reference in (flown, flown.record, Record.from_dict(flown.to_dict())):
        curves = known_curves(reference)
        assert curves is not None
        assert curves.across(0.5).value == pytest.approx(m.across.mtf_nyquist.value, abs=1e-5)
        assert curves.along(0.5).value == pytest.approx(m.along.mtf_nyquist.value, abs=1e-5)


def test_swapped_gsds_are_other_pixels() -> None:
    low, high, _ = rendered("trail", shape=SMALL)
    m = measured("trail", shape=SMALL)
    known = replace(m, image=replace(m.image, pixel_gsd_m=(15.0, 10.0)))
    image = ac.Image.from_array(high, Gsd(15.0, 10.0))
    assert ac.measure_biresolution(low, image, reference_mtf=known).reference_known
    coarse = ac.Image.from_array(low, Gsd(30.0, 20.0))
    assert ac.measure_biresolution(coarse, high, reference_mtf=known).reference_known
    swapped = ac.Image.from_array(high, Gsd(10.0, 15.0))
    with pytest.raises(ac.OptionError, match=r"15 m between rows, 10 m .* 10 m between rows"):
        ac.measure_biresolution(low, swapped, reference_mtf=known)
