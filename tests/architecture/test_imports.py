"""Arrows point down: which floor may import which, and who may import what from outside."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator

import pytest
from package_source import MODULES, ROOT, Import, all_imports, dotted_name

# From the roof to the ground. A floor imports itself and what stands after it.
FLOORS = (
    "cli",
    "report",
    "batch",
    "restoration",
    "studies",
    "scan",
    "archive",
    "targets",
    "simulate",
    "raster",
    "numerics",
    "geometry",
    "optics",
    "curves",
    "execution",
    "arguments",
    "errors",
    "names_on_use",
)

# The kinds of target: rooms of one floor that do not know one another.
KINDS = ("straight", "points", "pair", "periodic", "combine")

# Floors that may not be used although they stand lower: why.
FORBIDDEN = {
    ("simulate", "numerics"): "the truth shares no numerics with the estimators",
    ("raster", "numerics"): "files know nothing of fits",
    ("scan", "archive"): "who measures does not keep",
    ("studies", "archive"): "who simulates does not keep",
    ("restoration", "archive"): "a filter is made of one measurement",
}

# Libraries, and the floors that may use them.
LIBRARIES = {
    "numpy": set(FLOORS) - {"errors", "names_on_use"},
    "scipy": {
        "archive",
        "restoration",
        "scan",
        "targets",
        "simulate",
        "raster",
        "numerics",
        "optics",
    },
    "rasterio": {"raster"},
    "matplotlib": {"report"},
    "jinja2": {"report"},
    "markupsafe": {"report"},
    "typer": {"cli"},
    "rich": {"cli"},
    "numba": {"numerics"},
    "threadpoolctl": {"numerics"},
    "distributed": {"execution"},
    "pandas": {"archive", "scan"},
    "psycopg": {"archive"},
    "pyarrow": {"archive", "scan"},
    "pydantic": {"archive", "batch", "raster"},
    "orjson": {"archive"},
    "isal": {"archive"},
    "pystac": {"archive"},
    "sqlalchemy": {"archive"},
    "xarray": {"archive"},
}

# (module, imported module): why it is right all the same.
EXCEPTIONS: dict[tuple[str, str], str] = {}


# The same for imports of a higher floor.
UPWARD_EXCEPTIONS = {
    ("targets/directions.py", "acutance.report"): (
        "notebooks ask a result for HTML: _repr_html_ loads the reports only then"
    ),
    ("targets/target_result.py", "acutance.report"): "the same, of all edges of a target",
    ("scan/bands.py", "acutance.report"): "the same, of a scene in several bands",
}


def floor_of(module: str) -> str:
    return module.split("/")[0].removesuffix(".py")


def is_face(module: str) -> bool:
    """The package's own faces: the names of everything, and the command."""
    return module in ("__init__.py", "__main__.py")


def upward(found: Import) -> bool:
    """Whether an import of our own points to a higher floor."""
    own = floor_of(found.importer)
    other = found.target.split(".")[1]
    return FLOORS.index(other) < FLOORS.index(own)


def test_every_module_stands_on_a_floor() -> None:
    assert {floor_of(module) for module in MODULES if not is_face(module)} == set(FLOORS)


def own_imports() -> Iterator[Import]:
    """Imports of our own modules by any but the faces."""
    for found in all_imports():
        own = found.target.split(".")[0] == "acutance" and not is_face(found.importer)
        if own and found.target != "acutance.__version__":
            yield found


def test_own_imports_point_down() -> None:
    wrong = [
        str(found)
        for found in own_imports()
        if upward(found) and (found.importer, found.target) not in UPWARD_EXCEPTIONS
    ]
    assert not wrong


def kind_of(module: str) -> str | None:
    """The kind of target a module of the package belongs to, by its dotted name."""
    parts = module.split(".")
    return parts[2] if parts[1:2] == ["targets"] and parts[2:3] and parts[2] in KINDS else None


def test_kinds_of_target_do_not_know_one_another() -> None:
    strangers = [
        str(found)
        for found in all_imports()
        if floor_of(found.importer) == "targets"
        and kind_of(found.target) not in (None, kind_of(dotted_name(found.importer)))
    ]
    assert not strangers


@pytest.mark.parametrize(("floor", "other"), FORBIDDEN)
def test_floors_that_may_not_be_used(floor: str, other: str) -> None:
    wrong = [
        str(found)
        for found in all_imports()
        if floor_of(found.importer) == floor and found.target.split(".")[1:2] == [other]
    ]
    assert not wrong, FORBIDDEN[floor, other]


def test_no_relative_imports() -> None:
    assert not [str(found) for found in all_imports() if found.target.startswith(".")]


def foreign_imports() -> Iterator[tuple[Import, str]]:
    """Imports of libraries, with the library's name."""
    for found in all_imports():
        root = found.target.split(".")[0]
        if root != "acutance" and root not in sys.stdlib_module_names:
            yield found, root


def test_libraries_are_in_the_list() -> None:
    assert not [str(found) for found, root in foreign_imports() if root not in LIBRARIES]


def test_libraries_stay_on_their_floors() -> None:
    elsewhere = [
        str(found)
        for found, root in foreign_imports()
        if floor_of(found.importer) not in LIBRARIES.get(root, set())
        and (found.importer, found.target) not in EXCEPTIONS
    ]
    assert not elsewhere


def test_the_exceptions_are_all_needed() -> None:
    seen = {(found.importer, found.target) for found in all_imports()}
    assert set(EXCEPTIONS) | set(UPWARD_EXCEPTIONS) <= seen


def test_no_module_uses_pyplot() -> None:
    assert not [str(found) for found in all_imports() if "pyplot" in found.target]
    written = {module: (ROOT / module).read_text(encoding="utf-8") for module in MODULES}
    # Only what has the word, if in a comment, need be parsed.
    held = {module: text for module, text in written.items() if "pyplot" in text}
    named = [module for module, text in held.items() if "pyplot" in _names(text)]
    assert not named


def test_no_module_uses_the_distributions_of_scipy() -> None:
    """They take most of a second to load; `scipy.special` has all that is needed of them."""
    assert not [str(found) for found in all_imports() if found.target.startswith("scipy.stats")]


def _names(text: str) -> set[str]:
    """Every name and attribute that code uses."""
    tree = ast.parse(text)
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return names | {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}


def loaded_after(code: str) -> set[str]:
    """Roots of the modules a fresh interpreter has loaded after running some code."""
    program = f"{code}\nimport sys\nprint(*sorted({{m.split('.')[0] for m in sys.modules}}))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return set(done.stdout.splitlines()[-1].split())


def test_importing_acutance_loads_nothing_heavy() -> None:
    loaded = loaded_after("import acutance")
    assert "acutance" in loaded
    heavy = {
        "numpy",
        "scipy",
        "matplotlib",
        "rasterio",
        "pydantic",
        "jinja2",
        "typer",
        "sqlalchemy",
    }
    assert not loaded & heavy


def test_help_loads_nothing_heavy() -> None:
    """One process for all commands: what none of them loads each does not load."""
    commands = (
        [], ["edge"], ["simulate", "edge"], ["sites"], ["study"], ["demo"], ["restore", "apply"],
        ["niirs"], ["archive", "list"], ["batch"],
    )  # fmt: skip
    asked = [[*command, "--help"] for command in commands]
    loaded = loaded_after(
        "from acutance.cli.app import app\n"
        f"for words in {asked!r}:\n"
        "    app(words, standalone_mode=False)"
    )
    assert "typer" in loaded
    assert not loaded & {"scipy", "matplotlib", "rasterio", "jinja2", "sqlalchemy"}


def test_measuring_an_array_loads_the_straight_room_and_no_library_of_files_or_figures() -> None:
    program = (
        "import sys\n"
        "import acutance as ac\n"
        "sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])\n"
        "found = ac.measure_edge(ac.simulate.edge(sensor)[0])\n"
        "print(*[m for m in sys.modules if m.startswith('acutance.targets.')])\n"
        "ac.report.text(found)\n"
        "print(*{m.split('.')[0] for m in sys.modules})"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    measuring, told = (set(line.split()) for line in done.stdout.splitlines())
    assert {kind_of(name) for name in measuring} - {None} == {"straight"}
    assert "scipy" in told
    assert not told & {"rasterio", "matplotlib", "jinja2", "typer"}
