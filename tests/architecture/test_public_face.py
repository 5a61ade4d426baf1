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


def test_public_names_resolve_once_and_are_sorted() -> None:
    unknown = [
        f"{module.__name__}.{name}"
        for module in with_all()
        for name in module.__all__
        if not hasattr(module, name)
    ]
    assert not unknown
    unsorted = [
        module.__name__
        for module in with_all()
        if list(module.__all__) != sorted(set(module.__all__), key=sort_key)
    ]
    assert not unsorted


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


def documented_things() -> Iterator[tuple[str, Any]]:
    """Public functions and classes, and members of those that say what they are themselves."""
    for name, found in public_objects():
        yield name, found
        if inspect.isclass(found) and found.__name__ not in SAID_ELSEWHERE:
            for member, function in members(found):
                if member not in SAID_ELSEWHERE:
                    yield f"{name}.{member}", function


def test_public_things_have_docstrings() -> None:
    assert not [name for name, found in documented_things() if not inspect.getdoc(found)]


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


def with_entries(title: str) -> Iterator[tuple[str, FunctionType, list[str]]]:
    """Functions that have a section, with the names in it."""
    for name, function in functions():
        found = sections(inspect.getdoc(function) or "")
        if title in found:
            yield name, function, entries(found[title])


def test_parameters_are_those_of_the_signature() -> None:
    wrong = []
    for name, function, documented in with_entries("Parameters"):
        taken = [p for p in inspect.signature(function).parameters if p not in ("self", "cls")]
        if documented != taken:
            wrong.append(f"{name} takes {taken} and documents {documented}")
    assert not wrong


def test_top_functions_document_parameters() -> None:
    silent = []
    for name in sorted(acutance._HOMES):
        found = getattr(acutance, name, None)
        if not isinstance(found, FunctionType) or not inspect.signature(found).parameters:
            continue
        if not {"Parameters", "Returns"} <= set(sections(inspect.getdoc(found) or "")):
            silent.append(name)
    assert not silent


def test_raised_errors_exist() -> None:
    known = {*errors.__all__, "ValueError", "TypeError"}
    unknown = [
        f"{name} says it raises {error}"
        for name, _, raised in with_entries("Raises")
        for error in raised
        if error not in known
    ]
    assert not unknown


def test_modules_hold_one_noun() -> None:
    lines = {module: (ROOT / module).read_text(encoding="utf-8").count("\n") for module in MODULES}
    assert not {module: count for module, count in lines.items() if count > LONGEST}


def test_modules_are_named_after_something() -> None:
    vague = {*VAGUE, *(f"{word}s" for word in VAGUE)}
    assert not [module for module in MODULES if vague & set(re.split(r"[/_.]", module))]


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
