"""Groups of options: fields of a dataclass become options, and come back as the dataclass."""

import inspect
from dataclasses import dataclass
from typing import Annotated

import typer
from typer.testing import CliRunner

from acutance.cli.option_groups import with_groups


@dataclass(frozen=True)
class Place:
    row: Annotated[float, typer.Option(help="Of the centre.")]
    col: Annotated[float, typer.Option("--column")] = 3.0


def run(*words):
    seen = []

    @with_groups
    def measure(*, name: str, place: Place, often: Annotated[int, typer.Option()] = 1) -> None:
        """Measure."""
        seen.append((name, place, often))

    app = typer.Typer()
    app.command()(measure)
    result = CliRunner().invoke(app, list(words))
    return result, seen, measure


def test_a_group_is_gathered_from_its_options():
    result, seen, _ = run("x", "--row", "2", "--column", "5", "--often", "4")
    assert result.exit_code == 0, result.output
    assert seen == [("x", Place(2.0, 5.0), 4)]


def test_defaults_are_those_of_the_fields_and_a_field_without_one_is_required():
    assert run("x", "--row", "2")[1] == [("x", Place(2.0, 3.0), 1)]
    result, seen, _ = run("x")
    assert (result.exit_code, seen) == (2, [])
    assert "--row" in result.output


def test_options_keep_the_order_of_the_command():
    measure = run("--help")[2]
    assert list(inspect.signature(measure).parameters) == ["name", "row", "col", "often"]
    assert measure.__doc__ == "Measure."
