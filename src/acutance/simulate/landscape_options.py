"""What a landscape is made of: shares of objects and of what lies beside their borders."""

from __future__ import annotations

from dataclasses import dataclass, fields

from acutance.errors import ModelError
from acutance.optics.block import require, require_range

__all__ = ["LandscapeOptions", "Range"]

Range = tuple[float, float]
"""Lowest and highest of values that are drawn uniformly between them."""

_SHARE_GROUPS = (
    ("roofs", "roads", "discs"),
    ("rims", "gutters", "shadows", "side_roads", "neighbours"),
    ("soft",),
    ("curved",),
    ("dark",),
)


_SMALLEST_PX = {
    "field_px": 20.0,
    "roof_px": 20.0,
    "road_width_px": 2.0,
    "road_length_px": 20.0,
    "disc_radius_px": 2.0,
    "radius_px": 100.0,
    "line_width_px": 0.1,
    "shadow_width_px": 0.1,
}
"""What sizes have to be at least."""


@dataclass(frozen=True)
class LandscapeOptions:
    """What a landscape is made of. Levels are in image units, lengths in pixels.

    A range is (lowest, highest); values are drawn uniformly between the two. Contrasts of what
    lies beside a border are shares of that border's own.

    Parameters
    ----------
    density_per_mpx : float, optional
        Objects wanted in a million pixels; what finds no room is left out. An object is a field,
        a roof, a road or a disc, with all that lies beside it.
    clear_px : float, optional
        Least ground between one object and the next.
    ground : float, optional
        Mean level of the ground.
    contrast : (float, float), optional
        How far fields and roofs lie above or below it.
    dark : float, optional
        Share of objects darker than the ground, as far as its level allows.
    roofs, roads, discs : float, optional
        Shares of objects; the rest are fields.
    field_px, roof_px, road_width_px, road_length_px, disc_radius_px : (float, float), optional
        Sizes.
    soft : float, optional
        Share of borders that are soft on the ground; those of roofs never are.
    softness_px : (float, float), optional
        Standard deviation of the Gaussian that blurs a soft border.
    soft_normal_deg : (float, float), optional
        Borders are soft only where their normal lies between these directions, from the column
        axis towards the row axis; the others are ideal. A normal and its opposite are the same:
        45 to 135 are borders that face along, 135 to 225 those that face across.
    curved : float, optional
        Share of fields' borders that are arcs.
    radius_px : (float, float), optional
        Radius of the arcs, drawn uniformly in its logarithm.
    rims, gutters, shadows, side_roads, neighbours : float, optional
        Shares of the borders of fields and roofs, beside which such a thing lies; the rest are
        clean. Rims (bright or dark) and gutters (dark) are on either side, the others outside.
    line_contrast, line_width_px, line_distance_px : (float, float), optional
        Of rims and gutters. Half of them touch the border.
    shadow_contrast, shadow_width_px : (float, float), optional
        A shadow begins at the border.
    side_road_contrast, neighbour_contrast : (float, float), optional
        Either sign.
    gap_px : (float, float), optional
        From a border to the road or the neighbour beside it, where they are nearest.
    tilt_deg : float, optional
        Up to so much the direction of a road or a neighbour differs from that of the border.
    texture : (float, float), optional
        Standard deviation of the texture in the image as a share of the contrast: a parcel's own
        of its own contrast, that of the ground of the middle of `contrast`.
    texture_grain_px : float, optional
        Standard deviation of the texture's Gaussian grain, at least 0.5.
    slope_per_px : float, optional
        Root mean square slope of the ground, and highest slope of a parcel, as a share of the
        contrast per pixel.
    """

    density_per_mpx: float = 45.0
    clear_px: float = 24.0
    ground: float = 700.0
    contrast: Range = (250.0, 1000.0)
    dark: float = 0.35
    roofs: float = 0.35
    roads: float = 0.08
    discs: float = 0.08
    field_px: Range = (55.0, 120.0)
    roof_px: Range = (35.0, 60.0)
    road_width_px: Range = (4.0, 12.0)
    road_length_px: Range = (60.0, 200.0)
    disc_radius_px: Range = (5.0, 25.0)
    soft: float = 0.25
    softness_px: Range = (0.15, 0.6)
    soft_normal_deg: Range = (0.0, 180.0)
    curved: float = 0.2
    radius_px: Range = (300.0, 5000.0)
    rims: float = 0.12
    gutters: float = 0.08
    shadows: float = 0.1
    side_roads: float = 0.1
    neighbours: float = 0.12
    line_contrast: Range = (0.03, 0.15)
    line_width_px: Range = (1.0, 3.0)
    line_distance_px: Range = (0.5, 5.0)
    shadow_contrast: Range = (0.05, 0.3)
    shadow_width_px: Range = (3.0, 12.0)
    side_road_contrast: Range = (0.05, 0.6)
    neighbour_contrast: Range = (0.2, 1.0)
    gap_px: Range = (2.0, 14.0)
    tilt_deg: float = 5.0
    texture: Range = (0.01, 0.04)
    texture_grain_px: float = 1.5
    slope_per_px: float = 0.0005

    def __post_init__(self) -> None:
        require(self, 1.0, 2000.0, density_per_mpx=self.density_per_mpx)
        require(self, clear_px=self.clear_px, slope_per_px=self.slope_per_px)
        require(self, above=True, ground=self.ground)
        require(self, 0.0, 10.0, tilt_deg=self.tilt_deg)
        require(self, 0.5, texture_grain_px=self.texture_grain_px)
        for names in _SHARE_GROUPS:
            self._require_shares(names)
        for one in fields(self):
            if one.type == "Range":
                require_range(self, **{one.name: getattr(self, one.name)})
        for name, lowest in _SMALLEST_PX.items():
            require(self, lowest, **{name: getattr(self, name)[0]})
        require(self, 0.0, 360.0, soft_normal_deg=self.soft_normal_deg[1])

    def _require_shares(self, names: tuple[str, ...]) -> None:
        shares = {name: getattr(self, name) for name in names}
        require(self, 0.0, 1.0, **shares)
        if sum(shares.values()) > 1 + 1e-9:
            listed = ", ".join(f"{name} {share:g}" for name, share in shares.items())
            raise ModelError(
                f"LandscapeOptions: the shares {listed} add up to {sum(shares.values()):g}, "
                "they cannot exceed 1: lower one of them"
            )

    @property
    def typical_contrast(self) -> float:
        """Middle of the contrasts, which textures of the ground, slopes and SNR refer to."""
        return 0.5 * sum(self.contrast)
