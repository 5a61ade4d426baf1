"""What vendors put beside their images is read as it stands."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from acutance.raster import write_geotiff
from acutance.raster.metadata import read_statement

FOLDER = Path(__file__).parents[4] / "shared" / "data"

pytestmark = [
    pytest.mark.real,
    pytest.mark.skipif(not FOLDER.is_dir(), reason=f"no folder of real images at {FOLDER}"),
]

PRODUCTS = {
    "pleiades/DIM_PHR1A_P_202108271549303_SEN_5897098101-1.XML": (
        "IMG_PHR1A_P_202108271549303_SEN_5897098101-1_R1C1.JP2",
        {
            "sensor": "PHR1A",
            "level": "SENSOR",
            "acquired": datetime(2021, 8, 27, 15, 49, 31, 31000, UTC),
            "bands": ("P",),
            "gsd_m": (0.8967, 0.7783),
            "view_zenith_deg": 28.616,
            "sun_elevation_deg": 71.767,
            "sun_azimuth_deg": 115.233,
        },
    ),
    "pleiades/DIM_PHR1B_P_202201301008271_ORT_6153375101-1.XML": (
        "IMG_PHR1B_P_202201301008271_ORT_6153375101-1_R1C1.JP2",
        {
            "sensor": "PHR1B",
            "level": "ORTHO",
            "acquired": datetime(2022, 1, 30, 10, 8, 33, 31000, UTC),
            "bands": ("P",),
            "gsd_m": (0.5, 0.5),
            "view_zenith_deg": 12.947,
            "sun_elevation_deg": 59.914,
            "sun_azimuth_deg": 127.233,
        },
    ),
    "worldview2/18OCT01022604-M1BS-502541638020_01_P003.IMD": (
        "18OCT01022604-M1BS-502541638020_01_P003.NTF",
        {
            "sensor": "WV02",
            "level": "LV1B",
            "acquired": datetime(2018, 10, 1, 2, 26, 4, 585850, UTC),
            "bands": ("B", "G", "R", "N"),
            "gsd_m": (2.768, 2.905),
            "view_zenith_deg": 41.9,
            "view_azimuth_deg": 41.4,
            "sun_elevation_deg": 68.9,
            "sun_azimuth_deg": 96.3,
        },
    ),
    "landsat8/LC08_L1TP_112025_20210724_20210730_02_T1_MTL.txt": (
        "LC08_L1TP_112025_20210724_20210730_02_T1_B8.TIF",
        {
            "sensor": "LANDSAT_8",
            "level": "L1TP",
            "acquired": datetime(2021, 7, 24, 1, 42, 44, 432732, UTC),
            "bands": ("B8",),
            "gsd_m": (15.0, 15.0),
            "sun_elevation_deg": 56.19050509,
            "sun_azimuth_deg": 147.4282139,
        },
    ),
    "landsat8/LC80330352013157LGN00_MTL.txt": (
        "LC80330352013157LGN00_B4.TIF",
        {
            "sensor": "LANDSAT_8",
            "level": "L1T",
            "acquired": datetime(2013, 6, 6, 17, 40, 31, 751949, UTC),
            "bands": ("B4",),
            "gsd_m": (30.0, 30.0),
            "sun_elevation_deg": 68.159,
            "sun_azimuth_deg": 121.5095,
        },
    ),
    "kompsat3/K3_20201221013934_45861_11950876_L1G_Aux.xml": (
        "K3_20201221013934_45861_11950876_L1G_PB.tif",
        {
            "sensor": "KOMPSAT-3",
            "level": "Level1G",
            "acquired": datetime(2020, 12, 21, 1, 39, 42, 307041, UTC),
            "bands": ("PS1",),
            "gsd_m": (0.7, 0.7),
            "view_zenith_deg": 28.978,
            "view_azimuth_deg": 3.3938,
        },
    ),
    "gaofen2/GF2_PMS1_W91.0_N17.6_20200510_L1A0004793969-PAN1.xml": (
        "GF2_PMS1_W91.0_N17.6_20200510_L1A0004793969-PAN1.tiff",
        {
            "sensor": "GF2-PMS1",
            "level": "LEVEL1A",
            # 01:03:20 on the 11th in Beijing: the sun was 13.6 degrees from the zenith.
            "acquired": datetime(2020, 5, 10, 17, 3, 20, tzinfo=UTC),
            "bands": ("B5",),
            "gsd_m": (0.81, 0.81),
            "sun_elevation_deg": 76.4286,
            "sun_azimuth_deg": 86.6947,
        },
    ),
    "planetscope/20211121_020256_100c_3B_AnalyticMS_metadata.xml": (
        "20211121_020256_100c_3B_AnalyticMS.tif",
        {
            "sensor": "PlanetScope-100c",
            "level": "L3B",
            "acquired": datetime(2021, 11, 21, 2, 2, 56, tzinfo=UTC),
            "gsd_m": (3.0, 3.0),
            "view_zenith_deg": 5.4137,
            "sun_elevation_deg": 43.35266,
            "sun_azimuth_deg": 147.943,
        },
    ),
}


@pytest.mark.parametrize("document", PRODUCTS)
@pytest.mark.parametrize("beside", [True, False])
def test_products(document, beside, tmp_path):
    name, expected = PRODUCTS[document]
    source = FOLDER / "metadata" / document
    bands = len(expected.get("bands", ("one",)))
    write_geotiff(tmp_path / name, np.ones((bands, 16, 16), np.uint16))
    if beside:
        (tmp_path / source.name).write_bytes(source.read_bytes())
    found = read_statement(tmp_path / name, None if beside else [source])
    said = {key: one.value for key, one in found.stated.items()}
    assert set(said) == set(expected)
    for key, value in expected.items():
        if key in ("sensor", "level", "acquired", "bands"):
            assert said[key] == value
        else:
            assert said[key] == pytest.approx(value, rel=1e-4)
    assert found.conflicts == ()
    assert source.name in found.sensor.source


def test_the_text_and_the_xml_of_landsat_agree(tmp_path):
    name = "LC08_L1TP_112025_20210724_20210730_02_T1"
    folder = FOLDER / "metadata" / "landsat8"
    write_geotiff(tmp_path / f"{name}_B5.TIF", np.ones((16, 16), np.uint16))
    for ending in ("txt", "xml"):
        (tmp_path / f"{name}_MTL.{ending}").write_bytes(
            (folder / f"{name}_MTL.{ending}").read_bytes()
        )
    assert read_statement(tmp_path / f"{name}_B5.TIF").conflicts == ()


def test_a_granule_of_sentinel2(tmp_path):
    source, granule = FOLDER / "metadata" / "sentinel2", tmp_path / "S2.SAFE" / "GRANULE" / "L1C"
    (granule / "IMG_DATA").mkdir(parents=True)
    (granule / "MTD_TL.xml").write_bytes((source / "MTD_TL.xml").read_bytes())
    product = tmp_path / "S2.SAFE" / "MTD_MSIL1C.xml"
    product.write_bytes((source / "MTD_MSIL1C.xml").read_bytes())
    image = granule / "IMG_DATA" / "T18LTM_20220125T151701_B01.jp2"
    image.symlink_to(FOLDER / "scenes" / "22_s2a_T18LTM_B01_60m.jp2")
    found = read_statement(image)
    assert found.sensor.value == "Sentinel-2A"
    assert found.acquired.value == datetime(2022, 1, 25, 15, 26, 35, 509574, UTC)
    assert (found.bands.value, found.gsd_m.value) == (("B01",), (60.0, 60.0))
    assert found.view_zenith_deg.value == pytest.approx(9.27917)
    assert found.sun_elevation_deg.value == pytest.approx(61.62429)
    # The sun stood there at that time over the middle of the image.
    assert found.conflicts == ()


@pytest.mark.parametrize("view", [1, 2])
def test_a_date_that_stands_in_a_gml_tag_alone(view):
    found = read_statement(FOLDER / "scenes" / f"24_phr1a_aubagne_{view}.tif")
    assert found.sensor.value == "PHR1A"
    assert found.acquired.value.isoformat()[:16] == "2013-04-17T10:36"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.tif")) + sorted(FOLDER.glob("scenes/*")))
def test_no_image_says_what_it_does_not_know(path):
    found = read_statement(path)
    if "phr1a" not in path.name:
        assert set(found.stated) <= {"gsd_m"}
    assert found.conflicts == ()
