"""The command ``acutance`` and what it does with errors."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from acutance import __version__
from acutance.cli import (
    bars,
    biresolution,
    combine,
    demo,
    edge,
    plan_mirrors,
    points,
    pulse,
    simulate,
    sites,
    star,
    study,
)
from acutance.cli.terminal import fail, stop
from acutance.errors import AcutanceError

__all__ = ["app", "run"]


class _Commands(TyperGroup):
    """Commands whose expected errors are one message on stderr and exit code 2, and Ctrl-C 130."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except AcutanceError as error:
            fail(str(error))
        except MemoryError as error:
            fail(f"there is not enough memory ({error}): choose a smaller image or region")
        except KeyboardInterrupt as error:
            stop(str(error))


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Measure how sharp an Earth-observation satellite really sees.",
    epilog=edge.EXAMPLE,
)


def _print_version(asked: bool) -> None:
    if asked:
        typer.echo(f"acutance {__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Measure how sharp an Earth-observation satellite really sees.

    Exit codes: 0 measured, 2 bad usage or input, 3 measured but a check failed under --strict,
    130 interrupted.
    """


app.command("bars", epilog=bars.EXAMPLE)(bars.bars)
app.command("biresolution", epilog=biresolution.EXAMPLE)(biresolution.biresolution)
app.command("combine", epilog=combine.EXAMPLE)(combine.combine)
app.command("edge", epilog=edge.EXAMPLE)(edge.edge)
app.command("pulse", epilog=pulse.EXAMPLE)(pulse.pulse)
app.command("points", epilog=points.EXAMPLE)(points.points)
app.command("sites", epilog=sites.EXAMPLE)(sites.sites)
app.command("star", epilog=star.EXAMPLE)(star.star)
app.add_typer(simulate.app, name="simulate")
app.command("study", epilog=study.EXAMPLE)(study.study)
app.add_typer(plan_mirrors.app, name="plan")
app.command("demo", epilog=demo.EXAMPLE)(demo.demo)


def run() -> None:
    """Entry point of the command ``acutance``."""
    app(prog_name="acutance")
