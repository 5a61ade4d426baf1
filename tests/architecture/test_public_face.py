"""What a user may import: complete, sorted, documented, and of a readable size."""

from __future__ import annotations

import importlib
import inspect
import re
import tomllib
from collections.abc import Iterator
from importlib import metadata, resources
from types import FunctionType
from typing import Any

import pytest
from package_source import MODULES, ROOT, dotted_name

import acutance
from acutance import errors

PACKAGES = (
    "curves",
    "optics",
    "raster",
    "simulate",
    "geometry",
    "targets",
    "targets.straight",
    "targets.straight.published",
    "targets.points",
    "targets.pair",
    "targets.periodic",
    "targets.combine",
    "studies",
    "restoration",
    "report",
)
LONGEST = 400
VAGUE = ("util", "helper", "common", "manager", "factory", "registry", "misc", "tools", "base")

# Members without a docstring of their own: why.
SAID_ELSEWHERE = {
    "otf": "the same for all blocks: Block.otf says it",
    "read": "the same for all sources of pixels: PixelSource.read says it",
    "to_dict": "fields by name",
    "Truth": "its curves and numbers are those of Response",
}


def sort_key(name: str) -> tuple[int, str]:
    """CONSTANTS, then Classes, then the rest."""
    return (0 if name.isupper() else 1 if name[0].isupper() else 2), name


def with_all() -> list[Any]:
    modules = [importlib.import_module(dotted_name(module)) for module in MODULES]
    return [module for module in modules if hasattr(module, "__all__")]


def public_objects() -> Iterator[tuple[str, Any]]:
    """Functions and classes of every module's ``__all__``, where they are defined."""
    for module in with_all():
        for name in module.__all__:
            found = getattr(module, name, None)
            if getattr(found, "__module__", None) == module.__name__ and callable(found):
                yield f"{module.__name__}.{name}", found


def members(owner: type) -> Iterator[tuple[str, Any]]:
    """A class's own public functions and properties."""
    for name, member in vars(owner).items():
        if name.startswith("_"):
            continue
        function = getattr(member, "__func__", member)
        if isinstance(function, FunctionType | property) or hasattr(function, "func"):
            yield name, function


def test_every_module_says_what_is_public() -> None:
    silent = [
        module
        for module in MODULES
        if not hasattr(importlib.import_module(dotted_name(module)), "__all__")
        and not module.endswith("__init__.py")
    ]
    assert not silent


@pytest.mark.parametrize("module", with_all(), ids=lambda module: module.__name__)
def test_public_names_resolve_and_are_sorted(module: Any) -> None:
    names = list(module.__all__)
    assert not [name for name in names if not hasattr(module, name)]
    assert len(set(names)) == len(names)
    assert names == sorted(names, key=sort_key)


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_name_what_they_import(package: str) -> None:
    """What a package's `__init__` takes from its modules is public, and the other way round."""
    module = importlib.import_module(f"acutance.{package}")
    taken = {
        name
        for name, found in vars(module).items()
        if not name.startswith("_")
        and str(getattr(found, "__module__", "")).startswith(f"acutance.{package}.")
    }
    assert taken <= set(module.__all__)


def test_the_lazy_table_is_the_public_face() -> None:
    lazy = set(acutance._HOMES) | set(acutance._MODULES)
    assert lazy | set(errors.__all__) | {"__version__"} == set(acutance.__all__)
    for name, home in acutance._HOMES.items():
        assert name in importlib.import_module(home).__all__, f"{name} is not public in {home}"
    assert dir(acutance) == sorted(acutance.__all__)
    with pytest.raises(AttributeError, match="no attribute 'mtf'"):
        _ = acutance.mtf


ROOMS = {"archive", "batch", "execution", "scan"} | {one.split(".")[0] for one in PACKAGES}


@pytest.mark.parametrize("room", sorted(ROOMS))
def test_a_room_is_there_right_after_the_import(room: str) -> None:
    """Whatever was imported before: a notebook's cell must not depend on those above it."""
    assert acutance.__getattr__(room) is importlib.import_module(f"acutance.{room}")


def test_the_textbook_describes_every_package() -> None:
    page = ROOT.parents[1] / "docs" / "api.rst"
    if not page.is_file():
        pytest.skip("the textbook does not ship with an installed package")
    listed = set(re.findall(r"generated/(acutance[\w.]*)", page.read_text(encoding="utf-8")))
    public = {module.__name__ for module in with_all() if hasattr(module, "__path__")}
    assert public - {"acutance"} <= listed


@pytest.mark.parametrize(("name", "found"), list(public_objects()))
def test_public_things_have_docstrings(name: str, found: Any) -> None:
    assert inspect.getdoc(found), f"{name} has no docstring"
    if not inspect.isclass(found) or found.__name__ in SAID_ELSEWHERE:
        return
    bare = [
        member
        for member, function in members(found)
        if member not in SAID_ELSEWHERE and not inspect.getdoc(function)
    ]
    assert not bare, f"{name}: no docstring for {bare}"


def sections(doc: str) -> dict[str, str]:
    """Sections of a numpydoc docstring by title."""
    parts = re.split(r"^(\w[\w ]*)\n-{3,}$", doc, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def entries(section: str) -> list[str]:
    """Names at the left margin of a section: ``row, col : float`` names two."""
    lines = [line for line in section.splitlines() if line and not line[0].isspace()]
    return [name.strip(" *") for line in lines for name in line.split(" : ")[0].split(",")]


def functions() -> Iterator[tuple[str, FunctionType]]:
    for name, found in public_objects():
        if isinstance(found, FunctionType):
            yield name, found
        elif inspect.isclass(found):
            for member, function in members(found):
                if isinstance(function, FunctionType):
                    yield f"{name}.{member}", function


def functions_with(title: str) -> list[tuple[str, FunctionType]]:
    return [pair for pair in functions() if title in sections(inspect.getdoc(pair[1]) or "")]


@pytest.mark.parametrize(("name", "function"), functions_with("Parameters"))
def test_parameters_are_those_of_the_signature(name: str, function: FunctionType) -> None:
    documented = entries(sections(inspect.getdoc(function) or "")["Parameters"])
    taken = [p for p in inspect.signature(function).parameters if p not in ("self", "cls")]
    assert set(documented) <= set(taken), f"{name} documents parameters it does not have"
    assert [p for p in taken if p in documented] == documented, f"{name}: another order"
    assert set(taken) == set(documented), f"{name} does not document all of its parameters"


@pytest.mark.parametrize("name", sorted(acutance._HOMES))
def test_top_functions_document_parameters(name: str) -> None:
    found = getattr(acutance, name, None)
    if not isinstance(found, FunctionType) or not inspect.signature(found).parameters:
        return
    assert {"Parameters", "Returns"} <= set(sections(inspect.getdoc(found) or ""))


@pytest.mark.parametrize(("name", "function"), functions_with("Raises"))
def test_raised_errors_exist(name: str, function: FunctionType) -> None:
    for error in entries(sections(inspect.getdoc(function) or "")["Raises"]):
        known = error in errors.__all__ or error in ("ValueError", "TypeError")
        assert known, f"{name} says it raises {error}, which is no error of ours"


@pytest.mark.parametrize("module", MODULES)
def test_modules_are_short_and_named_after_something(module: str) -> None:
    lines = (ROOT / module).read_text(encoding="utf-8").count("\n")
    assert lines <= LONGEST, f"{module} has {lines} lines: it holds two nouns"
    words = set(re.split(r"[/_.]", module))
    vague = [word for word in VAGUE if {word, f"{word}s"} & words]
    assert not vague, f"{module} is named after nothing"


def test_type_information_ships() -> None:
    assert resources.files("acutance").joinpath("py.typed").is_file()


def test_versions_agree() -> None:
    assert metadata.version("acutance") == acutance.__version__
    pyproject = ROOT.parents[1] / "pyproject.toml"
    if pyproject.is_file():
        project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
        assert project["version"] == acutance.__version__


@pytest.mark.parametrize("name", errors.__all__)
def test_errors_are_builtins_at_once(name: str) -> None:
    error = getattr(errors, name)
    assert issubclass(error, errors.AcutanceError)
    if error is not errors.AcutanceError:
        assert issubclass(error, ValueError | OSError)
    assert name in (errors.__doc__ or ""), f"{name} is missing in the drawing of the tree"
