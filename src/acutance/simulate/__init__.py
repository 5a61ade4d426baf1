"""Targets seen by a sensor: images, and the truth they were made from."""

from acutance.simulate.edge import Truth, edge, render_edge
from acutance.simulate.ground import GroundNoise, alias_bands, render_raster
from acutance.simulate.noise import Noise
from acutance.simulate.pulse import PulseTruth, pulse, render_pulse
from acutance.simulate.resample import Regrid, resample
from acutance.simulate.scene import Patch, Strip, render_patches, render_strip, texture
from acutance.simulate.site import Scene, SceneEdge, checkerboard, site
from acutance.simulate.systems import reference_systems

__all__ = [
    "GroundNoise",
    "Noise",
    "Patch",
    "PulseTruth",
    "Regrid",
    "Scene",
    "SceneEdge",
    "Strip",
    "Truth",
    "alias_bands",
    "checkerboard",
    "edge",
    "pulse",
    "reference_systems",
    "render_edge",
    "render_patches",
    "render_pulse",
    "render_raster",
    "render_strip",
    "resample",
    "site",
    "texture",
]
