"""Targets seen by a sensor: images, and the truth they were made from."""

from acutance.simulate.bars import BarGroup, BarsTruth, bars
from acutance.simulate.campaign import Placed, brookings, render_site
from acutance.simulate.edge import Truth, edge, render_edge
from acutance.simulate.galaxy import Galaxy
from acutance.simulate.ground import GroundNoise, alias_bands, render_raster
from acutance.simulate.ground_of_pair import PairGround, pair_ground
from acutance.simulate.landscape import LandscapeTruth, landscape, landscape_tiles
from acutance.simulate.landscape_edges import Beside, LandscapeEdge
from acutance.simulate.landscape_layout import Waves
from acutance.simulate.landscape_options import LandscapeOptions
from acutance.simulate.native_grid import NativeGrid
from acutance.simulate.noise import Noise
from acutance.simulate.overflights import Overflight, overflights
from acutance.simulate.pair import PairTruth, pair
from acutance.simulate.parcel import Border, Parcel, SideStrip
from acutance.simulate.parcel_image import render_parcels
from acutance.simulate.points import PointsTruth, mirror_columns, mirror_square, points
from acutance.simulate.pulse import PulseTruth, pulse, render_pulse
from acutance.simulate.resample import Regrid, resample
from acutance.simulate.scene import (
    Patch,
    Point,
    Strip,
    add_patches,
    render_patches,
    render_strip,
    stamp,
    texture,
)
from acutance.simulate.sensor_field import SensorField, SoftCorners, TiltedFocus
from acutance.simulate.site import Scene, SceneEdge, SceneTarget, checkerboard, site
from acutance.simulate.sky import SkyField, SkyTruth, sky
from acutance.simulate.star import Star, StarTruth, add_star, star
from acutance.simulate.systems import reference_systems
from acutance.simulate.tarps import EdgeTarps, PulseTarp, tarp_patches, tarp_region, tarp_rows

__all__ = [
    "BarGroup",
    "BarsTruth",
    "Beside",
    "Border",
    "EdgeTarps",
    "Galaxy",
    "GroundNoise",
    "LandscapeEdge",
    "LandscapeOptions",
    "LandscapeTruth",
    "NativeGrid",
    "Noise",
    "Overflight",
    "PairGround",
    "PairTruth",
    "Parcel",
    "Patch",
    "Placed",
    "Point",
    "PointsTruth",
    "PulseTarp",
    "PulseTruth",
    "Regrid",
    "Scene",
    "SceneEdge",
    "SceneTarget",
    "SensorField",
    "SideStrip",
    "SkyField",
    "SkyTruth",
    "SoftCorners",
    "Star",
    "StarTruth",
    "Strip",
    "TiltedFocus",
    "Truth",
    "Waves",
    "add_patches",
    "add_star",
    "alias_bands",
    "bars",
    "brookings",
    "checkerboard",
    "edge",
    "landscape",
    "landscape_tiles",
    "mirror_columns",
    "mirror_square",
    "overflights",
    "pair",
    "pair_ground",
    "points",
    "pulse",
    "reference_systems",
    "render_edge",
    "render_parcels",
    "render_patches",
    "render_pulse",
    "render_raster",
    "render_site",
    "render_strip",
    "resample",
    "site",
    "sky",
    "stamp",
    "star",
    "tarp_patches",
    "tarp_region",
    "tarp_rows",
    "texture",
]
