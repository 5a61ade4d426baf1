"""``acutance sites``: the calibration sites that are known by name."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from acutance.raster import Site

__all__ = ["EXAMPLE", "sites"]

EXAMPLE = "\b\nExample:\n  acutance sites --json"


def sites(
    as_json: Annotated[
        bool, typer.Option("--json", help="Print all that is known of the sites as JSON.")
    ] = False,
) -> None:
    """List the edge targets that --site knows."""
    from acutance.curves.aligned_columns import align_columns
    from acutance.raster import sites as catalogue
    from acutance.report import json_text

    known = catalogue()
    if as_json:
        document = {"schema": "acutance/sites/1", "sites": [asdict(site) for site in known]}
        typer.echo(json_text(document))
        return
    header = ("name", "place", "latitude", "longitude", "size [m]", "panel [m]", "surface")
    typer.echo(align_columns([header, *(_row(site) for site in known)], "llrrrrl", indent=""))
    typer.echo(f"\nSource: {'; '.join(dict.fromkeys(site.source for site in known))}")


def _row(site: Site) -> tuple[str, ...]:
    return (
        site.name,
        site.title,
        _degrees(site.latitude_deg),
        _degrees(site.longitude_deg),
        "–" if site.size_m is None else f"{site.size_m:g}",
        f"{site.panel_size_m:g}",
        site.surface or "–",
    )


def _degrees(angle_deg: float | None) -> str:
    return "–" if angle_deg is None else f"{angle_deg:.5f}"
