"""
A region of a GeoTIFF by a polygon
==================================

A georeferenced image, a polygon drawn in a GIS around the target, and a measurement in metres.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_6_geotiff_region.png"

import json
import tempfile
from pathlib import Path

import numpy as np

import acutance as ac
from acutance import report
from acutance.raster import parse_roi, write_geotiff

# %%
# An image of a site, written as 16 bit GeoTIFF with pixels of 0.7 m in UTM zone 31.
folder = Path(tempfile.mkdtemp())
sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()], gsd_m=0.7)
scene = ac.simulate.site(sensor, np.random.default_rng(4))
west, north = 670_000.0, 4_830_000.0
write_geotiff(
    folder / "scene.tif",
    np.round(scene.image).astype(np.uint16),
    transform=(0.7, 0.0, west, 0.0, -0.7, north),
    crs="EPSG:32631",
)

# %%
# The polygon around one edge, in the coordinates of the map. Pixel centres are integers here and
# halves on the map.
edge = next(edge for edge in scene.edges if edge.name == "upper")
ring = [[west + 0.7 * (col + 0.5), north - 0.7 * (row + 0.5)] for row, col in edge.region]
polygon = {
    "type": "Polygon",
    "coordinates": [[*ring, ring[0]]],
    "crs": {"type": "name", "properties": {"name": "EPSG:32631"}},
}
(folder / "target.geojson").write_text(json.dumps(polygon))

# %%
# Only the window around the polygon is read. The GSD comes from the file, along the edge's normal.
image = ac.open_image(folder / "scene.tif")
region = parse_roi(str(folder / "target.geojson"), image)
measurement = ac.measure_edge(image, region)
print(image.gsd(), "region (row, column, height, width):", measurement.image.roi)
print(f"FWHM {measurement.fwhm_m} m, truth {edge.truth.fwhm_px.value * 0.7:.4f} m")
print(f"RER {measurement.rer}, truth {edge.truth.rer}")
for check in measurement.failed_checks:
    print(f"failed: {check.name} {check.value:.2f} {check.asked}: {check.message}")

# %%
# On the command line: ``acutance edge scene.tif --roi target.geojson --figure edge.png``.
figure = report.draw(measurement)

# %%
# The figure as a file.
figure.savefig("region.png", dpi=110)
print("wrote region.png")
