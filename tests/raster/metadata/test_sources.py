"""Each source says what its documents say, on small ones of the same structure."""

from __future__ import annotations

import json
from datetime import UTC, date, datetime

import pytest

DIMAP = """<?xml version="1.0" encoding="UTF-8"?>
<Dimap_Document>
  <Dataset_Content><Dataset_Extent><Center><LON>5.5</LON><LAT>43.3</LAT></Center></Dataset_Extent>
  </Dataset_Content>
  <Processing_Information><Product_Settings><PROCESSING_LEVEL>SENSOR</PROCESSING_LEVEL>
    <MTF_Settings><PAN_RESTORATION>true</PAN_RESTORATION></MTF_Settings></Product_Settings>
  </Processing_Information>
  <Raster_Data><Data_Access><Data_Files><Data_File>
    <DATA_FILE_PATH href="IMG_PHR1A_P_001_R1C1.JP2"/></Data_File></Data_Files></Data_Access>
    <BAND_ID>P</BAND_ID></Raster_Data>
  <Geometric_Data><Use_Area>
    <Located_Geometric_Values><LOCATION_TYPE>Top Center</LOCATION_TYPE>
      <TIME>2013-04-17T10:36:40.0Z</TIME></Located_Geometric_Values>
    <Located_Geometric_Values><LOCATION_TYPE>Center</LOCATION_TYPE>
      <TIME>2013-04-17T10:36:44.8Z</TIME>
      <Acquisition_Angles><AZIMUTH_ANGLE>180.1</AZIMUTH_ANGLE>
        <VIEWING_ANGLE>11.6</VIEWING_ANGLE><INCIDENCE_ANGLE>12.9</INCIDENCE_ANGLE>
      </Acquisition_Angles>
      <Solar_Incidences><SUN_AZIMUTH>150.5</SUN_AZIMUTH><SUN_ELEVATION>54.4</SUN_ELEVATION>
      </Solar_Incidences>
      <Ground_Sample_Distance><GSD_ACROSS_TRACK>0.71</GSD_ACROSS_TRACK>
        <GSD_ALONG_TRACK>0.73</GSD_ALONG_TRACK></Ground_Sample_Distance>
    </Located_Geometric_Values></Use_Area></Geometric_Data>
  <Dataset_Sources><Source_Identification><Strip_Source><MISSION>PHR</MISSION>
    <MISSION_INDEX>1A</MISSION_INDEX></Strip_Source></Source_Identification></Dataset_Sources>
</Dimap_Document>"""

IMD = """version = "28.3";
generationTime = 2018-10-01T19:43:12.000000Z;
bandId = "P";
productLevel = "LV1B";
BEGIN_GROUP = BAND_P
\tULLon = 119.78;
\tULLat = -0.87;
\tURLon = 120.01;
\tURLat = -0.80;
\tLRLon = 120.00;
\tLRLat = -0.97;
\tLLLon = 119.79;
\tLLLat = -1.03;
END_GROUP = BAND_P
BEGIN_GROUP = IMAGE_1
\tsatId = "WV02";
\tTLCList = (
\t(0,  0.000000),
\t(6775,  1.355000)\t);
\tfirstLineTime = 2018-10-01T02:26:04.585850Z;
\tmeanCollectedRowGSD = 2.7;
\tmeanProductRowGSD = 2.768;
\tmeanProductColGSD = 2.905;
\tmeanSunAz = 96.3;
\tmeanSunEl = 68.9;
\tmeanSatAz = 41.4;
\tmeanSatEl = 48.1;
END_GROUP = IMAGE_1
END;
"""

MTL = """GROUP = LANDSAT_METADATA_FILE
  GROUP = PRODUCT_CONTENTS
    PROCESSING_LEVEL = "L1TP"
    FILE_NAME_BAND_4 = "LC08_X_B4.TIF"
    FILE_NAME_BAND_8 = "LC08_X_B8.TIF"
    FILE_NAME_BAND_10 = "LC08_X_B10.TIF"
  END_GROUP = PRODUCT_CONTENTS
  GROUP = IMAGE_ATTRIBUTES
    SPACECRAFT_ID = "LANDSAT_8"
    DATE_ACQUIRED = 2021-07-24
    SCENE_CENTER_TIME = "01:42:44.4327320Z"
    SUN_AZIMUTH = 147.42821390
    SUN_ELEVATION = 56.19050509
  END_GROUP = IMAGE_ATTRIBUTES
  GROUP = PROJECTION_ATTRIBUTES
    GRID_CELL_SIZE_PANCHROMATIC = 15.00
    GRID_CELL_SIZE_REFLECTIVE = 30.00
    GRID_CELL_SIZE_THERMAL = 100.00
  END_GROUP = PROJECTION_ATTRIBUTES
END_GROUP = LANDSAT_METADATA_FILE
END
"""

MTD_TL = """<?xml version="1.0" encoding="UTF-8"?>
<n1:Level-1C_Tile_ID xmlns:n1="https://example.org/tile">
  <n1:General_Info><TILE_ID>S2A_OPER_MSI_L1C_TL_VGS2_A034442_T18LTM_N04.00</TILE_ID>
    <SENSING_TIME>2022-01-25T15:26:35.509574Z</SENSING_TIME></n1:General_Info>
  <n1:Geometric_Info><Tile_Angles>
    <Mean_Sun_Angle><ZENITH_ANGLE>28.4</ZENITH_ANGLE><AZIMUTH_ANGLE>107.1</AZIMUTH_ANGLE>
    </Mean_Sun_Angle>
    <Mean_Viewing_Incidence_Angle_List>
      <Mean_Viewing_Incidence_Angle bandId="3"><ZENITH_ANGLE>9.17</ZENITH_ANGLE>
        <AZIMUTH_ANGLE>102.4</AZIMUTH_ANGLE></Mean_Viewing_Incidence_Angle>
      <Mean_Viewing_Incidence_Angle bandId="8"><ZENITH_ANGLE>9.25</ZENITH_ANGLE>
        <AZIMUTH_ANGLE>103.2</AZIMUTH_ANGLE></Mean_Viewing_Incidence_Angle>
    </Mean_Viewing_Incidence_Angle_List></Tile_Angles></n1:Geometric_Info>
</n1:Level-1C_Tile_ID>"""

MTD_PRODUCT = """<n1:Level-1C_User_Product xmlns:n1="https://example.org/product">
  <n1:General_Info><Product_Info>
    <PRODUCT_START_TIME>2022-01-25T15:17:01.024Z</PRODUCT_START_TIME>
    <PRODUCT_URI>S2A_MSIL1C_20220125T151701_N0400_R125_T18LTM_20220125T190036.SAFE</PRODUCT_URI>
    <PROCESSING_LEVEL>Level-1C</PROCESSING_LEVEL>
    <Datatake><SPACECRAFT_NAME>Sentinel-2A</SPACECRAFT_NAME></Datatake></Product_Info>
    <Spectral_Information_List><Spectral_Information bandId="8" physicalBand="B8A">
      <RESOLUTION>20</RESOLUTION></Spectral_Information></Spectral_Information_List>
  </n1:General_Info></n1:Level-1C_User_Product>"""

KOMPSAT = """<?xml version="1.0" encoding="utf-8"?>
<Auxiliary><General><Satellite>KOMPSAT-3</Satellite><ProductLevel>Level1R</ProductLevel>
  <ApplyMTFC>true</ApplyMTFC></General>
  <Metadata><MetadataBlock><Time>20201221013942.23</Time><SunAngle><Azimuth>243.4</Azimuth>
    <Elevation>65.0</Elevation></SunAngle></MetadataBlock></Metadata>
  <Image>
    <PAN><ImageFileName>K3_001_L1R_P.tif</ImageFileName><ImageColor>Pan</ImageColor>
      <ImagingTime><ImagingCenterTime><UTC>20201221013942.3070411</UTC></ImagingCenterTime>
      </ImagingTime><Angle><Offnadir>25.9</Offnadir><Incidence>29.0</Incidence>
      <Azimuth>3.4</Azimuth></Angle><CollectedGSD><Column>0.802</Column><Row>0.893</Row>
      </CollectedGSD><ImageGSD><Column>0.7</Column><Row>0.7</Row></ImageGSD></PAN>
    <MS1><ImageFileName>K3_001_L1R_B.tif</ImageFileName><ImageColor>Blue</ImageColor></MS1>
  </Image></Auxiliary>"""

GAOFEN = """<?xml version="1.0" encoding="UTF-8"?>
<ProductMetaData><SatelliteID>GF2</SatelliteID><SensorID>PMS1</SensorID>
<ProductLevel>LEVEL1A</ProductLevel><Bands>5</Bands>
<CenterTime>2020-05-11 01:03:20</CenterTime><ImageGSD>0.81</ImageGSD>
<RollSatelliteAngle>15.0</RollSatelliteAngle><PitchSatelliteAngle>0.5</PitchSatelliteAngle>
<SolarAzimuth>86.7</SolarAzimuth><SolarZenith>13.57</SolarZenith>
<SatelliteZenith>{zenith}</SatelliteZenith>
<TopLeftLatitude>17.73</TopLeftLatitude><TopLeftLongitude>{west}</TopLeftLongitude>
<TopRightLatitude>17.68</TopRightLatitude><TopRightLongitude>{east}</TopRightLongitude>
<BottomRightLatitude>17.47</BottomRightLatitude><BottomRightLongitude>{east}</BottomRightLongitude>
<BottomLeftLatitude>17.52</BottomLeftLatitude><BottomLeftLongitude>{west}</BottomLeftLongitude>
</ProductMetaData>"""

PLANET = """<ps:EarthObservation xmlns:ps="p" xmlns:gml="g" xmlns:eop="e" xmlns:opt="o">
  <gml:metaDataProperty><ps:EarthObservationMetaData><eop:productType>L3B</eop:productType>
  </ps:EarthObservationMetaData></gml:metaDataProperty>
  <gml:using><eop:EarthObservationEquipment><eop:platform><eop:Platform>
    <eop:shortName>PlanetScope</eop:shortName><eop:serialIdentifier>100c</eop:serialIdentifier>
    </eop:Platform></eop:platform><eop:acquisitionParameters><ps:Acquisition>
    <eop:incidenceAngle>5.4</eop:incidenceAngle><ps:azimuthAngle>-11.4</ps:azimuthAngle>
    <opt:illuminationAzimuthAngle>147.9</opt:illuminationAzimuthAngle>
    <opt:illuminationElevationAngle>43.35</opt:illuminationElevationAngle>
    <ps:acquisitionDateTime>2021-11-21T10:02:56+08:00</ps:acquisitionDateTime>
    </ps:Acquisition></eop:acquisitionParameters></eop:EarthObservationEquipment></gml:using>
  <gml:target><gml:centerOf><gml:Point><gml:pos>121.87 20.24</gml:pos></gml:Point></gml:centerOf>
  </gml:target><gml:resultOf><ps:ProductInformation><ps:rowGsd>3.0</ps:rowGsd>
  <ps:columnGsd>3.0</ps:columnGsd></ps:ProductInformation></gml:resultOf></ps:EarthObservation>"""


def stac(asset: str = "scene.tif", **changes: object) -> str:
    properties = {
        "datetime": "2021-07-24T01:42:44Z",
        "platform": "landsat-8",
        "processing:level": "L1TP",
        "gsd": 30.0,
        "view:incidence_angle": 4.0,
        "view:off_nadir": 3.5,
        "view:azimuth": 100.0,
        **changes,
    }
    assets = {
        "data": {"href": f"data/{asset}", "gsd": 15.0, "eo:bands": [{"name": "pan"}]},
        "other": {"href": "data/other.tif", "gsd": 60.0},
    }
    item = {"type": "Feature", "stac_version": "1.0.0", "properties": properties, "assets": assets}
    return json.dumps(item)


def values(found):
    return {name: one.value for name, one in found.stated.items()}


def test_dimap(product):
    found = product("IMG_PHR1A_P_001_R1C1.tif", {"DIM_PHR1A_P_001.XML": DIMAP})
    assert values(found) == {
        "sensor": "PHR1A",
        "level": "SENSOR",
        "acquired": datetime(2013, 4, 17, 10, 36, 44, 800000, UTC),
        "bands": ("P",),
        "gsd_m": (0.73, 0.71),
        "view_zenith_deg": 12.9,
        "sun_elevation_deg": 54.4,
        "sun_azimuth_deg": 150.5,
    }
    assert found.sensor.source == "DIM_PHR1A_P_001.XML: MISSION, MISSION_INDEX"
    assert "AZIMUTH_ANGLE is the direction of the scan" in found.notes[0]
    assert "PAN_RESTORATION is true" in found.notes[1]


def test_a_dimap_of_other_images_says_nothing(product):
    found = product("IMG_PHR1A_P_001.tif", {"DIM_PHR1A_P_001.XML": DIMAP.replace("_001_", "_7_")})
    assert found.sensor is None
    assert "is about IMG_PHR1A_P_7_R1C1.JP2" in found.notes[0]


@pytest.mark.parametrize("as_xml", [False, True])
def test_imd(product, as_xml):
    name, text = "scene.IMD", IMD
    if as_xml:
        name = "scene.XML"
        text = (
            "<isd><IMD><BANDID>P</BANDID><PRODUCTLEVEL>LV1B</PRODUCTLEVEL><BAND_P><ULLON>119.78"
            "</ULLON></BAND_P><IMAGE><SATID>WV02</SATID>"
            "<FIRSTLINETIME>2018-10-01T02:26:04.585850Z</FIRSTLINETIME>"
            "<MEANPRODUCTROWGSD>2.768</MEANPRODUCTROWGSD>"
            "<MEANPRODUCTCOLGSD>2.905</MEANPRODUCTCOLGSD><MEANSUNAZ>96.3</MEANSUNAZ>"
            "<MEANSUNEL>68.9</MEANSUNEL><MEANSATAZ>41.4</MEANSATAZ><MEANSATEL>48.1</MEANSATEL>"
            "</IMAGE></IMD></isd>"
        )
    found = product("scene.tif", {name: text})
    assert values(found) == {
        "sensor": "WV02",
        "level": "LV1B",
        "acquired": datetime(2018, 10, 1, 2, 26, 4, 585850, UTC),
        "bands": ("P",),
        "gsd_m": (2.768, 2.905),
        "view_zenith_deg": pytest.approx(41.9),
        "view_azimuth_deg": 41.4,
        "sun_elevation_deg": 68.9,
        "sun_azimuth_deg": 96.3,
    }
    assert not found.conflicts


def test_bands_that_do_not_fit_the_image_are_left_out(product):
    text = IMD.replace("BAND_P", "BAND_B", 1) + "BEGIN_GROUP = BAND_G\nEND_GROUP = BAND_G\n"
    found = product("scene.tif", {"scene.IMD": text})
    assert found.bands is None
    assert "the image has 1: names are left out" in found.notes[-1]


@pytest.mark.parametrize(
    ("band", "gsd_m"), [("4", 30.0), ("8", 15.0), ("10", 100.0)], ids=["4", "8", "10"]
)
@pytest.mark.parametrize("form", ["txt", "xml", "json"])
def test_mtl(product, band, gsd_m, form):
    found = product(f"LC08_X_B{band}.TIF", {f"LC08_X_MTL.{form}": mtl_as(form)})
    assert values(found) == {
        "sensor": "LANDSAT_8",
        "level": "L1TP",
        "acquired": datetime(2021, 7, 24, 1, 42, 44, 432732, UTC),
        "bands": (f"B{band}",),
        "gsd_m": (gsd_m, gsd_m),
        "sun_elevation_deg": 56.19050509,
        "sun_azimuth_deg": 147.4282139,
    }


def test_the_temperature_of_landsat_is_of_the_band_of_level_1(product):
    """It was called BST_B10, with the GSD of the reflective bands."""
    text = MTL.replace("BAND_10", "BAND_ST_B10").replace("X_B10", "X_ST_B10")
    found = product("LC08_X_ST_B10.TIF", {"LC08_X_MTL.txt": text})
    assert (found.bands.value, found.gsd_m.value) == (("B10",), (100.0, 100.0))


def mtl_as(form: str) -> str:
    """The same content in three forms."""
    if form == "txt":
        return MTL
    from acutance.raster.metadata.odl import parse_odl

    groups = parse_odl(MTL.encode())
    if form == "json":
        return json.dumps(groups)

    def element(name, value):
        inner = value if isinstance(value, str) else "".join(element(*one) for one in value.items())
        return f"<{name}>{inner}</{name}>"

    return "".join(element(name, one) for name, one in groups.items())


def test_sentinel2(product):
    granule = "GRANULE/L1C_T18LTM_A034442"
    image = f"{granule}/IMG_DATA/T18LTM_20220125T151701_B8A.tif"
    found = product(image, {f"{granule}/MTD_TL.xml": MTD_TL, "MTD_MSIL1C.xml": MTD_PRODUCT})
    assert values(found) == {
        "sensor": "Sentinel-2A",
        "level": "Level-1C",
        "acquired": datetime(2022, 1, 25, 15, 26, 35, 509574, UTC),
        "bands": ("B8A",),
        "gsd_m": (20.0, 20.0),
        "view_zenith_deg": 9.25,
        "view_azimuth_deg": 103.2,
        "sun_elevation_deg": pytest.approx(61.6),
        "sun_azimuth_deg": 107.1,
    }
    assert not found.conflicts


def test_sentinel2_without_its_granule_has_the_time_of_the_datatake(product):
    found = product("T18LTM_20220125T151701_B8A.tif", {"MTD_MSIL1C.xml": MTD_PRODUCT})
    assert found.acquired.value == datetime(2022, 1, 25, 15, 17, 1, 24000, UTC)
    assert "is when the datatake began" in found.notes[0]


def test_a_granule_of_another_tile_says_nothing(product):
    found = product("T31TFJ_20220125T151701_B04.tif", {"MTD_TL.xml": MTD_TL})
    assert values(found) == {}
    assert found.notes == ("MTD_TL.xml is of tile T18LTM, the image of T31TFJ: not taken",)


def test_kompsat(product):
    found = product("K3_001_L1R_P.tif", {"K3_001_L1R_Aux.xml": "\ufeff" + KOMPSAT})
    assert values(found) == {
        "sensor": "KOMPSAT-3",
        "level": "Level1R",
        "acquired": datetime(2020, 12, 21, 1, 39, 42, 307041, UTC),
        "bands": ("PAN",),
        "gsd_m": (0.893, 0.802),
        "view_zenith_deg": 29.0,
        "view_azimuth_deg": 3.4,
    }
    assert "the point below the satellite" in found.notes[0]
    assert "ApplyMTFC" in found.notes[1]


def test_kompsat_on_a_map_has_the_grid_of_the_map(product):
    text = KOMPSAT.replace("Level1R", "Level1G")
    found = product("K3_001_L1R_P.tif", {"K3_001_L1R_Aux.xml": text})
    assert found.gsd_m.value == (0.7, 0.7)


def test_the_zone_of_gaofen_follows_from_the_sun(product):
    text = GAOFEN.format(zenith=16.5, west=-91.1, east=-90.9)
    found = product("scene.tif", {"scene.xml": text})
    assert found.acquired.value == datetime(2020, 5, 10, 17, 3, 20, tzinfo=UTC)
    assert "Beijing time" in found.acquired.source
    assert found.sensor.value == "GF2-PMS1"
    assert found.sun_elevation_deg.value == pytest.approx(76.43)
    assert found.view_zenith_deg.value == 16.5


def test_gaofen_where_the_sun_does_not_tell_the_zone(product):
    found = product("scene.tif", {"scene.xml": GAOFEN.format(zenith=74.8, west=10, east=10.2)})
    assert found.acquired is None
    assert found.view_zenith_deg is None
    assert "time stays empty" in found.notes[0]
    assert "contradicts the attitude, 15.0 degrees off nadir" in found.notes[1]


def test_planetscope(product):
    found = product("scene.tif", {"scene_metadata.xml": PLANET})
    assert values(found) == {
        "sensor": "PlanetScope-100c",
        "level": "L3B",
        "acquired": datetime(2021, 11, 21, 2, 2, 56, tzinfo=UTC),
        "gsd_m": (3.0, 3.0),
        "view_zenith_deg": 5.4,
        "sun_elevation_deg": 43.35,
        "sun_azimuth_deg": 147.9,
    }
    assert "azimuthAngle is the direction of the scan" in found.notes[0]
    assert not found.conflicts


def test_stac_item(product):
    found = product("scene.tif", {"item.json": stac()})
    assert values(found) == {
        "sensor": "landsat-8",
        "level": "L1TP",
        "acquired": datetime(2021, 7, 24, 1, 42, 44, tzinfo=UTC),
        "bands": ("pan",),
        "gsd_m": (15.0, 15.0),
        "view_zenith_deg": 4.0,
        "view_azimuth_deg": 100.0,
    }


def test_a_stac_item_without_the_image_says_nothing(product):
    found = product("scene.tif", {"item.json": stac("another.tif")})
    assert values(found) == {}
    assert "without an asset scene.tif" in found.notes[0]


def test_a_gsd_in_degrees_is_not_taken(product):
    text = stac().replace("15.0", "3.19e-05")
    found = product("scene.tif", {"item.json": text})
    assert found.gsd_m is None
    assert "which no image has" in found.notes[0]


def test_tags(product):
    tags = {
        "SENSOR": "SIM-1",
        "ACQUISITION_DATETIME": "2026-01-05T12:00:00+02:00",
        "SUN_ELEVATION": "41.5",
        "TIFFTAG_DATETIME": "2009:01:16 15:26:43",
    }
    found = product("scene.tif", {}, tags=tags, gsd_m=0.7)
    assert values(found) == {
        "sensor": "SIM-1",
        "acquired": datetime(2026, 1, 5, 10, tzinfo=UTC),
        "gsd_m": (0.7, 0.7),
        "sun_elevation_deg": 41.5,
    }
    assert "is when the file was written: not taken" in found.notes[0]


@pytest.mark.parametrize("text", ["2150-01-05T12:00:00Z", "2150-01-05", "1900-01-01", "9999-12-31"])
def test_a_time_of_no_image_is_not_taken(product, text):
    found = product("scene.tif", {}, tags={"ACQUISITION_DATETIME": text})
    assert found.acquired is None
    assert any(note.endswith("not taken") and text[:10] in note for note in found.notes)


def test_a_time_without_a_zone_is_named(product):
    found = product("scene.tif", {}, tags={"ACQUISITION_DATETIME": "2026-01-05 12:00:00"})
    assert found.acquired.value == datetime(2026, 1, 5, 12, tzinfo=UTC)
    assert found.notes == ("scene.tif: tag ACQUISITION_DATETIME names no time zone: taken as UTC",)


@pytest.mark.parametrize("text", ["20021216151629", "yesterday", "2026-13-05", "9999-99-99 1:2:3"])
def test_what_is_no_time_of_acquisition(product, text):
    found = product("scene.tif", {}, tags={"NITF_IDATIM": text})
    assert found.acquired is None
    assert f"tag NITF_IDATIM, {text}, is" in found.notes[0]


@pytest.mark.parametrize("text", ["2026-01-05", "20260105", "2026:01:05", "2026/01/05"])
def test_a_day_without_a_time_is_a_date(product, text):
    found = product("scene.tif", {}, tags={"ACQUISITION_DATE": text})
    assert found.acquired.value == date(2026, 1, 5)
    assert type(found.acquired.value) is date
    assert found.notes == ("scene.tif: tag ACQUISITION_DATE names a day and no time",)
    assert found.to_dict()["acquired"]["value"] == "2026-01-05"


def test_the_time_of_the_same_day_goes_before_the_day(product):
    def dated(when):
        item = {"scene.json": stac(datetime=when)}
        return product("scene.tif", item, tags={"ACQUISITION_DATETIME": "2026-01-05T10:00:00Z"})

    same = dated("2026-01-05")
    assert same.acquired.value == datetime(2026, 1, 5, 10, tzinfo=UTC)
    assert same.conflicts == ()
    other = dated("2026-01-06")
    assert other.acquired.value == date(2026, 1, 6)
    assert other.conflicts[0].startswith("acquired: 2026-01-06")


def test_gml_of_a_data_strip(product):
    gml = "<gml:name>DS_PHR1A_201304171036448_FR1_PX_E005N43_0707_01658</gml:name>"
    found = product("scene.tif", {}, tags={"gml.root-instance": gml})
    assert values(found) == {
        "sensor": "PHR1A",
        "acquired": datetime(2013, 4, 17, 10, 36, 44, 800000, UTC),
    }
