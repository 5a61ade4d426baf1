"""Files that an editor has put a byte order mark before are read as those without."""

from codecs import BOM_UTF8

import pytest

import acutance as ac
from acutance.archive import Archive
from acutance.archive.specification import read_specification
from acutance.cli.documents import read_json
from acutance.optics.sensor_file import read_sensor, write_sensor
from acutance.report.json import json_text


def marked(path, content):
    path.write_bytes(BOM_UTF8 + (content if isinstance(content, bytes) else content.encode()))
    return path


@pytest.mark.parametrize(("to", "name"), [("jsonl", "o.jsonl"), ("csv-documents", "o.csv")])
def test_exports(entry_of, tmp_path, to, name):
    with Archive(tmp_path / "x.db") as archive:
        archive.add_entries(entry_of(i) for i in range(3))
        archive.export(tmp_path / name, to=to)
    again = marked(tmp_path / f"again-{name}", (tmp_path / name).read_bytes())
    with Archive(tmp_path / "again.db") as archive:
        done = archive.import_documents(again)
    assert (done.new, done.refused) == (3, {})


def test_documents(edge_record, tmp_path):
    place = marked(tmp_path / "m.json", json_text(edge_record.document))
    with Archive(tmp_path / "x.db") as archive:
        assert archive.import_documents(place).new == 1
    assert read_json(str(place))["schema"] == "acutance/measurement/1"


def test_specifications(tmp_path):
    place = marked(tmp_path / "s.toml", '[[requirement]]\nmetric = "mtf_nyquist"\nminimum = 0.1\n')
    assert len(read_specification(place).requirement) == 1


def test_sensors(tmp_path):
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)
    write_sensor(sensor, tmp_path / "s.toml")
    again = marked(tmp_path / "again.toml", (tmp_path / "s.toml").read_bytes())
    assert read_sensor(again) == read_sensor(tmp_path / "s.toml")
