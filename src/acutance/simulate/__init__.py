"""Targets seen by a sensor: images, and the truth they were made from."""

from acutance.simulate.edge import Truth, edge, render_edge
from acutance.simulate.noise import Noise

__all__ = ["Noise", "Truth", "edge", "render_edge"]
