"""Landscapes of parcels on bare ground: nothing beside an edge but the two levels it separates."""

import numpy as np

import acutance as ac
from acutance.simulate import LandscapeOptions, landscape

BARE = {
    "roofs": 0.0, "roads": 0.0, "discs": 0.0, "rims": 0.0, "gutters": 0.0, "shadows": 0.0,
    "side_roads": 0.0, "neighbours": 0.0, "texture": (0.0, 0.0), "slope_per_px": 0.0,
    "curved": 0.0, "density_per_mpx": 60,
}  # fmt: skip


def bare_ground(**changed):
    """Options of a landscape of parcels alone; 60 objects a megapixel unless changed."""
    return LandscapeOptions(**(BARE | changed))


def all_of_softness(softness_px, **changed):
    """The same, all objects with one softness; ideal ones without any."""
    if not softness_px:
        return bare_ground(soft=0.0, **changed)
    return bare_ground(soft=1.0, softness_px=(softness_px, softness_px + 1e-9), **changed)


def small_scene(sensor, size_px, soft, seed):
    """Bare ground of few parcels at SNR 100, a share of their borders soft by .15 to 2 px."""
    image, _ = landscape(
        sensor, shape=(size_px, size_px), options=bare_ground(soft=soft, softness_px=(0.15, 2.0)),
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    return image + np.random.default_rng((*seed, 1)).normal(0, 10.0, image.shape)


def check_of_bare_ground(name, sensor, size_px, density_per_mpx, seed):
    """A scan of bare ground at SNR 100 under a sensor, and one of its checks."""
    image, _ = landscape(
        sensor, shape=(size_px, size_px), snr=100,
        options=bare_ground(density_per_mpx=density_per_mpx), rng=np.random.default_rng(seed),
    )  # fmt: skip
    scene = ac.scan_scene(image)
    (check,) = (one for one in scene.checks if one.name == name)
    return scene, check
