"""A record in bytes: stored small, sent between processes quickly."""

import pickle

import numpy as np
import pytest

import acutance as ac
from acutance.curves import METRICS
from acutance.targets import OtfSlices, Record
from acutance.targets.document_fields import DocumentFields, WrittenLater
from acutance.targets.record import rounded


@pytest.fixture(scope="module")
def record():
    sensor = ac.simulate.reference_systems()["asymmetric"]
    image, _ = ac.simulate.edge(sensor, angle_deg=6, snr=100, rng=np.random.default_rng(1))
    return ac.measure_edge(image, gsd_m=0.7).record


def with_waste(record, numbers):
    """The record with a field of so many numbers that cannot be compressed."""
    waste = np.random.default_rng(2).standard_normal(numbers).tolist()
    return Record.from_dict({**record.to_dict(), "waste": waste})


def test_numbers_of_a_record_are_found_by_direction(record):
    with pytest.raises(AttributeError, match=r"read \.across\.mtf_nyquist"):
        _ = record.mtf_nyquist
    assert not hasattr(record, "colour")
    with pytest.raises(ac.OptionError, match=r"json\.loads\(text\)"):
        Record.from_dict("{}")


@pytest.mark.parametrize("numbers", [0, 2000])
def test_a_pickled_record_is_the_record(record, numbers):
    sent = with_waste(record, numbers)
    assert pickle.loads(pickle.dumps(sent)) == sent
    assert pickle.loads(pickle.dumps(sent)).to_dict() == sent.to_dict()


def test_what_is_written_later_is_written_once_in_its_place():
    written = []
    fields = DocumentFields({
        "first": WrittenLater(lambda: written.append("first") or [1.0]), "second": 2.0
    })  # fmt: skip
    assert (fields["second"], written) == (2.0, [])
    assert list(dict(fields).items()) == [("first", [1.0]), ("second", 2.0)]
    assert fields["first"] is fields["first"]
    assert written == ["first"]


def test_it_takes_15_kilobytes_pickled_and_less_stored(record):
    assert len(record.to_bytes()) < len(pickle.dumps(record)) <= 15_000
    assert Record.from_bytes(record.to_bytes()) == record


def test_a_direction_has_every_number_by_its_name(record):
    across = record.across
    assert {name: getattr(across, name) for name in METRICS} == across.numbers
    without = Record.from_dict({**record.to_dict(), "fwhm_m": None})
    assert without.across.fwhm_m is None


def test_what_does_not_fit_quickly_is_compressed_as_it_is_stored(record):
    large = with_waste(record, 2000)
    assert large.to_bytes() in pickle.dumps(large)


def test_a_covariance_has_one_document():
    rng = np.random.default_rng(3)
    freq = np.arange(1, 17) * 0.05
    factor = 0.01 * (rng.standard_normal((16, 6)) + 1j * rng.standard_normal((16, 6)))
    turn = np.linalg.qr(rng.standard_normal((6, 6)))[0]
    one, other = (
        OtfSlices(np.zeros(1), freq, np.exp(-freq) + 0j, found).to_dict()
        for found in (factor, factor @ turn)
    )
    for part in ("factor_real", "factor_imag"):
        assert np.array(one[part]) == pytest.approx(np.array(other[part]), abs=1.1e-4)


def test_the_smallest_of_numbers_are_written_as_zero():
    assert rounded([1e-310, 1.23456789, 5e-324]) == [0.0, 1.23457, 0.0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mtf_nyquist": "x"}, "mtf_nyquist is 'x', no value with its standard deviation"),
        ({"rer": {"value": "x", "std": 0.1}}, "rer is {'value': 'x'"),
        ({"fwhm_px": {"value": 1.2}}, "fwhm_px is {'value': 1.2}, no value with its"),
        ({"snr": "x"}, "could not convert string to float: 'x'"),
        ({"measured_at": "yesterday"}, "yesterday"),
        ({"orientation": 5, "measured_directions": ["across"]}, "across"),
    ],
)
def test_a_damaged_document_is_refused_when_it_is_read(record, change, message):
    with pytest.raises(ac.OptionError, match=f"cannot be read as a measurement .*{message}"):
        Record.from_dict({**record.to_dict(), **change})
