"""The catalogue of edge targets and where they lie in an image."""

import numpy as np
import pytest
import rasterio

from acutance.errors import OptionError, RegionError
from acutance.raster import Image, find_site, open_image, site_region, sites


def located(write_raster, site, gsd_m=0.5, size_px=400, crs="EPSG:3857"):
    """An image of `size_px` pixels with a site in its middle."""
    from rasterio.warp import transform

    (x,), (y,) = transform("EPSG:4326", crs, [site.longitude_deg], [site.latitude_deg])
    half = gsd_m * size_px / 2
    return open_image(
        write_raster(
            "scene.tif",
            np.ones((size_px, size_px), np.uint8),
            crs=crs,
            transform=rasterio.Affine(gsd_m, 0, x - half, 0, -gsd_m, y + half),
        )
    )


def test_the_catalogue():
    names = [site.name for site in sites()]
    assert names == [
        "salon-de-provence",
        "stennis",
        "penghu",
        "big-spring",
        "baotou",
        "longmont",
    ]
    for site in sites():
        assert site.source
        assert site.notes
        assert site.extent_m >= 40


@pytest.mark.parametrize(
    ("name", "lat", "lon"),
    [
        ("salon", 43 + 36 / 60 + 21 / 3600, 5 + 7 / 60 + 13 / 3600),
        ("stennis", 30 + 23 / 60 + 12 / 3600, -(89 + 37 / 60 + 43 / 3600)),
        ("penghu", 23 + 31 / 60 + 11 / 3600, 119 + 35 / 60),
        ("baotou", 40 + 51 / 60 + 6 / 3600, 109 + 37 / 60 + 44 / 3600),
        ("longmont", (40.13590 + 40.13557) / 2, -(105.14453 + 105.14454) / 2),
    ],
)
def test_coordinates(name, lat, lon):
    site = find_site(name)
    assert site.latitude_deg == pytest.approx(lat, abs=1e-6)
    assert site.longitude_deg == pytest.approx(lon, abs=1e-6)


@pytest.mark.parametrize(
    "name",
    ["salon-de-provence", "Salon de Provence", "SALON", "salón", "Salon-de-Provence, France", "sa"],
)
def test_names_are_read_kindly(name):
    assert find_site(name).name == "salon-de-provence"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("stenis", "did you mean stennis"),
        ("Atlantis", "the sites are salon-de-provence, stennis"),
        ("b", "any of big-spring, baotou"),
        ("", "there is no site"),
    ],
)
def test_names_that_are_no_site(name, message):
    with pytest.raises(OptionError, match=message):
        find_site(name)


@pytest.mark.parametrize("name", ["salon", "stennis", "penghu", "baotou", "longmont"])
def test_the_square_around_a_site(write_raster, name):
    site = find_site(name)
    zone = int((site.longitude_deg + 180) // 6) + 1
    image = located(write_raster, site, crs=f"EPSG:326{zone:02d}")
    box = site_region(site, image, margin_m=10.0).box(image.shape)
    side = (site.extent_m + 20) / 0.5
    assert box.height == pytest.approx(side, abs=1)
    assert box.width == pytest.approx(side, abs=1)
    assert box.row + box.height / 2 == pytest.approx(200, abs=1)
    assert box.col + box.width / 2 == pytest.approx(200, abs=1)


def test_the_square_is_as_large_as_the_ground_on_a_web_map(write_raster):
    site = find_site("salon")
    image = located(write_raster, site, gsd_m=1.0)
    box = site_region(site, image, margin_m=0.0).box(image.shape)
    assert box.height == pytest.approx(60 / np.cos(np.radians(site.latitude_deg)), rel=0.02)


def test_both_squares_of_longmont_lie_in_its_region(write_raster):
    site = find_site("Longmont, Colorado")
    image = located(write_raster, site, crs="EPSG:32613")
    row, col = image.geolocation.from_lonlat([-105.14453, -105.14454], [40.13590, 40.13557])
    assert row[1] - row[0] == pytest.approx(73.3, abs=0.5)
    box = site_region(site, image, margin_m=0.0).box(image.shape)
    half_px = 0.5 * site.panel_size_m / 0.5
    assert (row - half_px >= box.row - 1).all()
    assert (row + half_px <= box.row + box.height).all()
    assert (np.abs(col - 200) < 5).all()
    assert "WorldView-2 of 2014-06-20" in site.source
    assert "KOMPSAT" in find_site("baotou").source


def test_a_scene_without_the_site(write_raster):
    image = located(write_raster, find_site("salon"))
    with pytest.raises(RegionError, match="does not contain Stennis Space Center, USA"):
        site_region(find_site("stennis"), image)


def test_an_image_without_a_crs():
    with pytest.raises(RegionError, match=r"no CRS, .*--roi ROW,COL,HEIGHT,WIDTH"):
        site_region(find_site("salon"), Image.from_array(np.ones((9, 9)), gsd_m=0.7))


def test_a_site_whose_place_is_not_published(write_raster):
    image = located(write_raster, find_site("salon"))
    with pytest.raises(RegionError, match=r"not published .*--roi"):
        site_region(find_site("big-spring"), image)


def test_a_margin_that_means_nothing(write_raster):
    with pytest.raises(OptionError, match="margin of -1 m"):
        site_region(find_site("salon"), located(write_raster, find_site("salon")), margin_m=-1)
