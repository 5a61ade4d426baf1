"""Targets seen by a sensor: images, and the truth they were made from."""

from acutance.simulate.bars import BarGroup, BarsTruth, bars
from acutance.simulate.campaign import Placed, brookings, render_site
from acutance.simulate.edge import Truth, edge, render_edge
from acutance.simulate.ground import GroundNoise, alias_bands, render_raster
from acutance.simulate.native_grid import NativeGrid
from acutance.simulate.noise import Noise
from acutance.simulate.pair import PairGround, PairTruth, pair, pair_ground
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
from acutance.simulate.site import Scene, SceneEdge, SceneTarget, checkerboard, site
from acutance.simulate.star import Star, StarTruth, add_star, star
from acutance.simulate.systems import reference_systems
from acutance.simulate.tarps import EdgeTarps, PulseTarp, tarp_patches, tarp_region, tarp_rows

__all__ = [
    "BarGroup",
    "BarsTruth",
    "EdgeTarps",
    "GroundNoise",
    "NativeGrid",
    "Noise",
    "PairGround",
    "PairTruth",
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
    "Star",
    "StarTruth",
    "Strip",
    "Truth",
    "add_patches",
    "add_star",
    "alias_bands",
    "bars",
    "brookings",
    "checkerboard",
    "edge",
    "mirror_columns",
    "mirror_square",
    "pair",
    "pair_ground",
    "points",
    "pulse",
    "reference_systems",
    "render_edge",
    "render_patches",
    "render_pulse",
    "render_raster",
    "render_site",
    "render_strip",
    "resample",
    "site",
    "stamp",
    "star",
    "tarp_patches",
    "tarp_region",
    "tarp_rows",
    "texture",
]
