"""Where a survey lies in an image, at the ends of the Earth too."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.batch.find_line import edge_candidates, grown
from acutance.batch.find_points import find_points
from acutance.batch.place_target import NotHereError, place_target
from acutance.errors import RegionError
from acutance.raster import Box, Geolocation, Gsd, Image
from acutance.raster.surveyed_targets import targets_of


def target(points, shape="LineString", crs=None, **properties):
    document = {
        "type": "Feature",
        "geometry": {"type": shape, "coordinates": points},
        "properties": {"kind": "edge", "name": "edge", **properties},
    }
    return targets_of(document, "targets", crs)[0]


def image_at(transform, crs, shape=(200, 200)):
    from dataclasses import replace

    return replace(Image.from_array(np.zeros(shape)), geolocation=Geolocation(transform, crs))


def placed(survey, image):
    return place_target(survey, image, image.geolocation)


@pytest.mark.parametrize("west", [179.999, -180.001])
@pytest.mark.parametrize("turn", [0.0, -360.0])
def test_across_the_antimeridian(west, turn):
    image = image_at((1e-5, 0.0, west, 0.0, -1e-5, 10.001), "EPSG:4326")
    found = placed(target([[179.9995 + turn, 10.0], [180.0005 + turn, 10.0002]]), image)
    assert found.points == pytest.approx(np.array([[99.5, 49.5], [79.5, 149.5]]), abs=1e-5)


def test_a_line_over_the_antimeridian_stays_short():
    image = image_at((1e-5, 0.0, 179.999, 0.0, -1e-5, 10.001), "EPSG:4326")
    found = placed(target([[179.9998, 10.0], [-179.9998, 10.0]]), image)
    assert np.ptp(found.points[:, 1]) == pytest.approx(40.0, abs=1e-6)


def test_the_pole():
    # Polar stereographic: the pole is the origin, in the middle of the image.
    image = image_at((1.0, 0.0, -100.0, 0.0, -1.0, 100.0), "EPSG:3031")
    found = placed(target([[0.0, -89.9995], [180.0, -89.9995]]), image)
    middle = found.points.mean(axis=0)
    assert middle == pytest.approx([99.5, 99.5], abs=0.1)
    utm = image_at((1.0, 0.0, 5e5, 0.0, -1.0, 5e6), "EPSG:32631")
    with pytest.raises(NotHereError) as caught:
        placed(target([[0.0, 90.0], [1.0, 89.9]]), utm)
    assert caught.value.why in ("outside", "no georeference")


def test_a_point_is_a_square_of_metres():
    image = image_at((0.5, 0.0, 6e5, 0.0, -0.5, 5e6), "EPSG:32631")
    survey = target([6e5 + 50, 5e6 - 50], "Point", "EPSG:32631", size_m=20, position_std_m=2)
    found = placed(survey, image)
    assert np.ptp(found.points, axis=0) == pytest.approx([40.0, 40.0])
    assert found.search_px == pytest.approx(12.0)
    assert found.gsd == Gsd(0.5, 0.5)


def test_pixels_without_a_gsd():
    plain = Image.from_array(np.zeros((100, 100)))
    found = place_target(target([[20, 10], [20, 60]], crs="pixel"), plain, None)
    assert found.points.tolist() == [[10, 20], [60, 20]]
    assert (found.gsd, found.search_px) == (None, 6.0)
    with pytest.raises(NotHereError, match="GSD"):
        place_target(target([50, 50], "Point", "pixel", size_m=20), plain, None)
    square = place_target(target([50, 50], "Point", "pixel", size_px=20), plain, None)
    assert np.ptp(square.points, axis=0) == pytest.approx([20.0, 20.0])


def test_a_crs_that_is_unknown():
    image = image_at((0.5, 0.0, 6e5, 0.0, -0.5, 5e6), "EPSG:999999")
    with pytest.raises(NotHereError, match="is not known"):
        placed(target([[0, 0], [1, 1]], crs="EPSG:32631"), image)


def test_targets_that_reach_the_border():
    image = image_at((0.5, 0.0, 6e5, 0.0, -0.5, 5e6), "EPSG:32631")

    def at(first, last):
        points = [[6e5 + 0.5 * (c + 0.5), 5e6 - 0.5 * (r + 0.5)] for r, c in (first, last)]
        return target(points, crs="EPSG:32631", position_std_m=1)

    assert placed(at((50, -10), (50, 90)), image)
    for far, why in (((50, -90), "clipped"), ((-50, -50), "clipped")):
        with pytest.raises(NotHereError) as caught:
            placed(at(far, (50, 30)), image)
        assert caught.value.why == why
    with pytest.raises(NotHereError) as caught:
        placed(at((50, 300), (50, 400)), image)
    assert caught.value.why == "outside"


def test_an_image_located_by_rpc_needs_a_height_of_the_targets_it_may_show():
    from rasterio.rpc import RPC

    from acutance.raster.sensor_model import SensorModel

    def polynomial(**terms):
        places = {"one": 0, "lon": 1, "lat": 2, "height": 3}
        found = [0.0] * 20
        for name, value in terms.items():
            found[places[name]] = value
        return found

    rpc = RPC(
        height_off=200.0, height_scale=100.0, lat_off=43.0, lat_scale=0.01, long_off=5.0,
        long_scale=0.01, line_off=100.0, line_scale=500.0, samp_off=100.0, samp_scale=500.0,
        line_num_coeff=polynomial(lat=-1.0), line_den_coeff=polynomial(one=1.0),
        samp_num_coeff=polynomial(lon=1.0, height=0.05), samp_den_coeff=polynomial(one=1.0),
        err_bias=None, err_rand=None,
    )  # fmt: skip
    image, model = Image.from_array(np.zeros((200, 200))), SensorModel("OGC:CRS84", rpc=rpc)

    def why(lon):
        survey = target([[lon, 43.0], [lon + 0.0005, 43.0]], position_std_m=5)
        with pytest.raises(NotHereError) as caught:
            place_target(survey, image, model)
        return caught.value.why

    assert why(5.0) == "no height"
    assert why(4.9977) == "no height"
    assert (why(4.99), why(5.01), why(80.0)) == ("outside",) * 3


@pytest.mark.parametrize(
    ("crs", "name"), [("pixel", "position_std_px"), ("EPSG:32631", "position_std_m")]
)
def test_what_is_not_found_is_told_the_deviation_that_counts(crs, name):
    line, points = (
        ([[50, 50], [50, 90]], [[50, 50], [70, 90]])
        if crs == "pixel"
        else ([[6e5 + 50, 5e6 - 50], [6e5 + 50, 5e6 - 90]], [[6e5 + 50, 5e6 - 50]])
    )
    image = image_at((1.0, 0.0, 6e5, 0.0, -1.0, 5e6), "EPSG:32631")
    with pytest.raises(RegionError, match=f"state a larger {name}$"):
        edge_candidates(placed(target(line, crs=crs), image), image)
    survey = target(points, "MultiPoint", crs, kind="points")
    with pytest.raises(RegionError, match=f"state a larger {name}$"):
        find_points(placed(survey, image), image)
    with pytest.raises(RegionError, match=f"state a smaller {name}$"):
        placed(target(line, crs=crs, **{name: 1000}), image)


def test_metres_of_uncertainty_need_a_gsd():
    """Of a map without a unit: it was looked for within three times 2 px, which nobody stated."""
    local = 'LOCAL_CS["works",UNIT["unknown",1]]'
    image = image_at((1.0, 0.0, 0.0, 0.0, -1.0, 200.0), local)
    survey = target([[50, 100], [52, 150]], crs=local, position_std_m=1)
    with pytest.raises(NotHereError, match=r"\(position_std_m\) is not: state it") as caught:
        placed(survey, image)
    assert caught.value.why == "no GSD"
    assert place_target(survey, image, image.geolocation, Gsd(0.5, 0.5)).search_px == 6


@pytest.mark.parametrize("width", [12, 30, 100])
def test_an_outline_grows_equally_on_every_side(width):
    """A narrow one, too: its corners alone would move along the diagonal."""
    plain = Image.from_array(np.zeros((200, 200)))
    low, high = 100 - width / 2, 100 + width / 2
    corners = [[low, 50], [high, 50], [high, 150], [low, 150], [low, 50]]
    survey = target([corners], "Polygon", "pixel", position_std_px=5)
    found = grown(place_target(survey, plain, None)).box(plain.shape)
    assert found == Box(35, int(low) - 15, 130, width + 30)
