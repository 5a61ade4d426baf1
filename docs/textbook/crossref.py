"""Links to the short names of ``import acutance as ac``: each leads to the thing's own page.

And signatures that name the aliases of types as the code does.
"""

from __future__ import annotations

import re
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


def _plain_aliases(
    app: Any, what: str, name: str, found: Any, options: Any, signature: Any, returned: Any
) -> tuple[Any, Any]:
    """A signature without the wrapper that stands for an alias inside a union."""
    wrapper = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")
    return tuple(text and wrapper.sub(r"\1", text) for text in (signature, returned))


def setup(app: Any) -> None:
    app.connect("autodoc-process-signature", _plain_aliases)
    app.connect("missing-reference", _home)
