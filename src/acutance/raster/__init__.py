"""Images in and out, regions, geolocation, sites. Only files opened here load rasterio."""

from acutance.raster.fill import Fill, find_fill, value_far_off
from acutance.raster.geolocation import Geolocation
from acutance.raster.gsd import Gsd
from acutance.raster.image import Image
from acutance.raster.linearization import LogCurve, PowerCurve, SrgbCurve, TableCurve
from acutance.raster.open_image import open_bands, open_image
from acutance.raster.positions import read_positions
from acutance.raster.region import Box, Region
from acutance.raster.roi import parse_roi, parse_rois
from acutance.raster.site import Site, find_site, site_region, sites
from acutance.raster.swath_fill import SwathFill, find_swath_fill
from acutance.raster.writing import write_geotiff, write_geotiff_tiles

__all__ = [
    "Box",
    "Fill",
    "Geolocation",
    "Gsd",
    "Image",
    "LogCurve",
    "PowerCurve",
    "Region",
    "Site",
    "SrgbCurve",
    "SwathFill",
    "TableCurve",
    "find_fill",
    "find_site",
    "find_swath_fill",
    "open_bands",
    "open_image",
    "parse_roi",
    "parse_rois",
    "read_positions",
    "site_region",
    "sites",
    "value_far_off",
    "write_geotiff",
    "write_geotiff_tiles",
]
