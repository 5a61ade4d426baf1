"""The catalogue of permanent edge targets, and where they lie in an image."""

from __future__ import annotations

import difflib
import functools
import json
import unicodedata
from dataclasses import dataclass
from importlib import resources

import numpy as np

from acutance.arguments import require_kind, require_numbers
from acutance.errors import OptionError, RegionError
from acutance.raster.image import Image, require_image
from acutance.raster.region import Region

__all__ = ["Site", "find_site", "site_region", "sites"]


@dataclass(frozen=True)
class Site:
    """A permanent edge target.

    Parameters
    ----------
    name : str
        In lower case with hyphens: "salon-de-provence".
    title : str
        Place and country.
    latitude_deg, longitude_deg : float or None
        Of the target, WGS 84, to about one second of arc (30 m); ``None`` if not published.
    size_m : float or None
        Side of the whole target, metres; ``None`` if not published.
    panel_size_m : float
        Side of one uniform panel, metres.
    pattern : str or None
        How the panels lie.
    surface : str or None
        What they are made of.
    orientation_deg : tuple of float
        Of the edges, from true north; empty if not published.
    status : str or None
        As the source reports it.
    notes : str
        How these numbers were found, and what is uncertain.
    source : str
        Where they come from.
    """

    name: str
    title: str
    latitude_deg: float | None
    longitude_deg: float | None
    size_m: float | None
    panel_size_m: float
    pattern: str | None
    surface: str | None
    orientation_deg: tuple[float, ...]
    status: str | None
    notes: str
    source: str

    @property
    def extent_m(self) -> float:
        """Side of the ground to look at: the whole target, or two panels if it is not known."""
        return 2.0 * self.panel_size_m if self.size_m is None else self.size_m


@functools.cache
def sites() -> tuple[Site, ...]:
    """The catalogue: the sites of its source in their order, then others with theirs."""
    text = resources.files("acutance.raster").joinpath("sites.json").read_text(encoding="utf-8")
    catalogue = json.loads(text)
    return tuple(
        Site(
            **{
                "source": catalogue["source"],
                **entry,
                "orientation_deg": tuple(entry["orientation_deg"] or ()),
            }
        )
        for entry in catalogue["sites"]
    )


def find_site(name: str) -> Site:
    """The site of a name; case, accents, spaces and hyphens do not matter.

    Parameters
    ----------
    name : str
        The name or the title, or a beginning of it that only one site has: "Salon de Provence",
        "salon".

    Raises
    ------
    OptionError
        If no site has the name, or several begin with it.
    """
    require_kind(str, name=name)
    wanted = _plain(name)
    found = [
        site
        for site in sites()
        if wanted
        and (_plain(site.name).startswith(wanted) or _plain(site.title).startswith(wanted))
    ]
    if len(found) == 1:
        return found[0]
    if found:
        names = ", ".join(site.name for site in found)
        raise OptionError(f"the site {name!r} may be any of {names}: write more of its name")
    known = [site.name for site in sites()]
    close = difflib.get_close_matches(name.casefold(), known, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise OptionError(f"there is no site {name!r}: {hint}the sites are {', '.join(known)}")


def site_region(site: Site, image: Image, margin_m: float = 30.0) -> Region:
    """The square of an image around a site.

    Its sides follow the rows and columns of the image. The published coordinates are good to
    about 30 m, hence the margin.

    Parameters
    ----------
    site : Site
    image : Image
        With a CRS.
    margin_m : float
        Ground around the target on every side, metres; not negative.

    Returns
    -------
    Region
        It may reach beyond the image when the site is near its border.

    Raises
    ------
    RegionError
        If the coordinates of the site are not published, the image has no CRS or GSD, or the
        site's centre lies outside it.
    OptionError
        If the margin is negative, or an argument of the wrong kind.
    """
    require_kind(Site, site=site)
    require_image(image)
    require_numbers(margin_m=margin_m)
    if not margin_m >= 0.0:
        raise OptionError(f"a margin of {margin_m:g} m means nothing: give 0 or more metres")
    if site.latitude_deg is None or site.longitude_deg is None:
        raise RegionError(
            f"the coordinates of {site.title} are not published in the documents acutance has: "
            "find the target in the image and give it with --roi ROW,COL,HEIGHT,WIDTH"
        )
    if image.geolocation is None:
        raise RegionError(
            f"the image has no CRS, so {site.title} cannot be found in it: "
            "give the region in pixels with --roi ROW,COL,HEIGHT,WIDTH"
        )
    where = image.geolocation.from_lonlat(site.longitude_deg, site.latitude_deg)
    rows, cols = image.shape
    row, col = float(where[0]), float(image.geolocation.nearest_turn(where[1], cols))
    if not (-0.5 <= row < rows - 0.5 and -0.5 <= col < cols - 0.5):
        raise RegionError(
            f"the image does not contain {site.title}: {site.latitude_deg:.5f}, "
            f"{site.longitude_deg:.5f} (latitude, longitude) falls on row {row:.0f}, "
            f"column {col:.0f} of {rows} rows x {cols} columns"
        )
    gsd = image.gsd(row, col)
    if gsd is None:
        raise RegionError(
            f"the GSD of the image is not known, so the size of {site.title} in it is not: "
            "give it with --gsd"
        )
    half_m = site.extent_m / 2 + margin_m
    half = np.array([half_m / gsd.row_m, half_m / gsd.col_m])
    corners = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]])
    return Region(np.array([row, col]) + corners * half)


def _plain(name: str) -> str:
    """Letters and digits only, lower case, accents removed."""
    decomposed = unicodedata.normalize("NFKD", name).casefold()
    return "".join(letter for letter in decomposed if letter.isalnum())
