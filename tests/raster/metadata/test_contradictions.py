"""What sources say differently is named, what cannot be read is a note, and nothing crashes."""

from __future__ import annotations

from datetime import UTC, date, datetime

import numpy as np
import pytest
from test_sources import DIMAP, IMD, MTL, stac

from acutance.errors import ImageError
from acutance.raster import write_geotiff
from acutance.raster.metadata import read_statement
from acutance.raster.metadata.sun import sun_angles
from acutance.raster.metadata.times import time_or_day, utc_time

PLACE = {"crs": "EPSG:32653", "transform": (60.0, 0.0, 669150.0, 0.0, -60.0, 5572050.0)}
"""In the middle of the Landsat scene, with pixels of twice its bands'."""


def test_an_image_that_says_nothing(product):
    found = product("scene.tif", {})
    assert found.stated == {}
    assert (found.conflicts, found.notes) == ((), ())


def test_the_geotransform_goes_before_documents_and_differences_are_named(product):
    found = product("LC08_X_B4.TIF", {"LC08_X_MTL.txt": MTL}, **PLACE)
    assert found.gsd_m.value == pytest.approx((60.0, 60.0))
    assert found.gsd_m.source == "LC08_X_B4.TIF: geotransform"
    (conflict,) = found.conflicts
    assert conflict.startswith(
        "gsd_m: [60.0, 60.0] (LC08_X_B4.TIF: geotransform), but [30.0, 30.0]"
    )


def test_sources_that_agree_are_no_contradiction(product):
    documents = {"LC08_X_MTL.txt": MTL, "item.json": stac("LC08_X_B8.TIF", gsd=15.0)}
    found = product("LC08_X_B8.TIF", {**documents, "LC08_X_MTL.json": "{}"})
    assert [one for one in found.conflicts if not one.startswith("bands")] == []


def test_every_field_that_differs_is_named(product):
    other = stac("LC08_X_B8.TIF", platform="landsat-9", datetime="2021-07-25T01:42:44Z")
    found = product("LC08_X_B8.TIF", {"LC08_X_MTL.txt": MTL, "item.json": other})
    assert found.sensor.value == "LANDSAT_8"
    assert [one.split(":")[0] for one in found.conflicts] == ["sensor", "acquired", "bands"]


def test_a_time_at_which_the_sun_stood_elsewhere(product):
    right = product("LC08_X_B4.TIF", {"LC08_X_MTL.txt": MTL}, **PLACE)
    assert not [one for one in right.conflicts if one.startswith("sun")]
    wrong = product(
        "LC08_X_B4.TIF", {"LC08_X_MTL.txt": MTL.replace("01:42:44", "09:42:44")}, **PLACE
    )
    (conflict,) = (one for one in wrong.conflicts if one.startswith("sun"))
    assert "time, its zone, angle or place is wrong" in conflict


BILLION = b"""<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY lol "lol">
<!ENTITY lol2 "&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;">]>
<Dimap_Document>&lol2;</Dimap_Document>"""


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"<Dimap_Document><A></Dimap_Document>", "not well-formed"),
        (b"<", "not well-formed"),
        (BILLION, "declares entities"),
        (b"<?xml version='1.0' encoding='martian'?><a/>", "not well-formed"),
        (b"<a>\xff\xfe</a>", "not well-formed"),
        ("<a>é</a>".encode("utf-16-le"), "kind that is not known"),
        (b"<a>" * 200 + b"</a>" * 200, "nested more than 100 deep"),
        (b"", "holds no line NAME = VALUE"),
        (b"\x00\x01\x02" * 50, "holds no line"),
        (b'{"type": "Feature"', "cannot be read"),
        (b"{" + b'"a":{' * 100_000, "cannot be read"),
        (b"[1, 2]", "holds no line"),
        (b"<PAMDataset/>", None),
        (b"<Something/>", "kind that is not known"),
        (b"A = 1\nB = 2\n", "kind that is not known"),
    ],
)
@pytest.mark.parametrize("name", ["scene.xml", "scene.IMD", "scene.json"])
def test_documents_that_are_none(product, content, reason, name):
    found = product("scene.tif", {name: content})
    assert found.stated == {}
    if reason is None and name != "scene.json":
        assert found.notes == ()
    else:
        assert len(found.notes) == 1
        assert name in found.notes[0]
    if name == "scene.xml" and reason is not None:
        assert reason in found.notes[0]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1"])
def test_encodings(product, encoding):
    declared = {"utf-8-sig": "utf-8", "iso-8859-1": "ISO-8859-1"}.get(encoding, encoding)
    text = DIMAP.replace('encoding="UTF-8"', f'encoding="{declared}"').replace(
        "<MISSION>", "<COPYRIGHT>©</COPYRIGHT><MISSION>"
    )
    found = product("IMG_PHR1A_P_001_R1C1.tif", {"DIM_PHR1A_P_001.XML": text.encode(encoding)})
    assert found.sensor.value == "PHR1A"


@pytest.mark.parametrize("value", ["nan", "inf", "1e999", "ninety", "-1", "123456789"])
def test_angles_that_are_none(product, value):
    text = IMD.replace("meanSunEl = 68.9", f"meanSunEl = {value}")
    found = product("scene.tif", {"scene.IMD": text})
    if value == "-1":
        assert found.sun_elevation_deg.value == -1.0
    else:
        assert found.sun_elevation_deg is None
    assert found.sensor.value == "WV02"


def test_documents_named_by_the_user_replace_those_beside(tmp_path):
    write_geotiff(tmp_path / "crop.tif", np.ones((16, 16), np.uint16))
    (tmp_path / "crop.IMD").write_text(IMD)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "DIM.XML").write_text(DIMAP)
    found = read_statement(tmp_path / "crop.tif", [elsewhere / "DIM.XML"])
    assert (found.sensor.value, found.path) == ("PHR1A", str(tmp_path / "crop.tif"))
    with pytest.raises(ImageError, match=r"none\.xml was named .* no such file"):
        read_statement(tmp_path / "crop.tif", [elsewhere / "none.xml"])


def test_an_image_that_is_none(tmp_path):
    (tmp_path / "scene.tif").write_bytes(b"not a TIFF")
    with pytest.raises(ImageError, match="cannot be read"):
        read_statement(tmp_path / "scene.tif")


def test_an_array_says_nothing(tmp_path):
    np.save(tmp_path / "scene.npy", np.ones((16, 16)))
    assert read_statement(tmp_path / "scene.npy").stated == {}


def test_names_of_bands(tmp_path):
    import rasterio

    path = tmp_path / "scene.tif"
    write_geotiff(path, np.ones((2, 16, 16), np.uint16), crs="EPSG:32631",
                  transform=(1.0, 0.0, 5e5, 0.0, -1.0, 5e6))  # fmt: skip
    with rasterio.open(path, "r+") as dataset:
        dataset.descriptions = ("pan", "near\n infrared")
    found = read_statement(path)
    names = ["pan", "near infrared"]
    assert [found.band_name(number) for number in (0, 1, 2, 3)] == [None, *names, None]
    assert found.to_dict()["bands"] == {
        "value": names,
        "source": "scene.tif: descriptions of the bands",
    }


@pytest.mark.parametrize(
    ("when", "lon", "lat", "elevation", "azimuth"),
    [
        # The NOAA solar calculator, without refraction.
        (datetime(2026, 6, 21, 12, 0, tzinfo=UTC), 0.0, 51.4779, 61.95, 178.9),
        (datetime(2026, 12, 21, 0, 0, tzinfo=UTC), 180.0, -23.4, 89.3, 60.0),
        (datetime(2026, 3, 20, 6, 0, tzinfo=UTC), 0.0, 0.0, -1.85, 90.0),
    ],
)
def test_the_sun(when, lon, lat, elevation, azimuth):
    found = sun_angles(when, lon, lat)
    assert found[0] == pytest.approx(elevation, abs=0.3)
    if elevation < 80:
        assert found[1] == pytest.approx(azimuth, abs=0.5)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2018-10-01T02:26:04.585850Z", datetime(2018, 10, 1, 2, 26, 4, 585850, UTC)),
        ("2018-10-01T02:26:04.5858501234Z", datetime(2018, 10, 1, 2, 26, 4, 585850, UTC)),
        ("20201221013941.1409645", datetime(2020, 12, 21, 1, 39, 41, 140964, UTC)),
        ("2020:12:21 01:39:41", datetime(2020, 12, 21, 1, 39, 41, tzinfo=UTC)),
        ("2021-11-21T02:02:56+00:00", datetime(2021, 11, 21, 2, 2, 56, tzinfo=UTC)),
        ("2016-12-31T23:59:60Z", datetime(2017, 1, 1, tzinfo=UTC)),
        ("20161231235960.25", datetime(2017, 1, 1, 0, 0, 0, 250000, UTC)),
        ("2017-01-01T08:59:60+09:00", datetime(2017, 1, 1, tzinfo=UTC)),
        ("2021-152T10:00:00Z", datetime(2021, 6, 1, 10, tzinfo=UTC)),
        ("2021-06-01T24:00:00Z", datetime(2021, 6, 2, tzinfo=UTC)),
        ("2021:06:01 24:00:00", datetime(2021, 6, 2, tzinfo=UTC)),
        ("2021-366T10:00:00Z", None),
        ("2021-06-01T24:00:01Z", None),
        ("2021-06-01T12:34:60Z", None),
        ("2021-11-21", None),
        ("", None),
        ("0001-01-01T00:00:00+12:00", None),
        ("1800-01-01T00:00:00Z", None),
        (5, None),
        ("1" * 100, None),
    ],
)
def test_times(text, expected):
    assert utc_time(text) == expected


def test_a_day_of_the_year_is_a_day():
    assert (time_or_day("2020-366"), time_or_day("2021-366")) == (date(2020, 12, 31), None)
