"""Links to the short names of ``import acutance as ac``: each leads to the thing's own page."""

from __future__ import annotations

from typing import Any

import acutance

__all__ = ["setup"]


def _home(app: Any, env: Any, node: Any, content: Any) -> Any:
    """Resolve ``acutance.Sensor`` or ``Sensor`` as the name in the package that holds it."""
    short = str(node.get("reftarget", "")).removeprefix("acutance.")
    if node.get("refdomain") != "py" or short not in acutance.__all__:
        return None
    package = acutance._HOMES.get(short, "acutance.errors")
    domain = env.get_domain("py")
    return domain.resolve_xref(
        env, node["refdoc"], app.builder, node["reftype"], f"{package}.{short}", node, content
    )


def setup(app: Any) -> None:
    app.connect("missing-reference", _home)
