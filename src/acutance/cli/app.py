"""The command ``acutance`` and what it does with errors."""

from __future__ import annotations

import atexit
import gc
import re
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup, TyperOption

from acutance import __version__
from acutance.cli import (
    archive,
    bars,
    batch,
    biresolution,
    combine,
    demo,
    edge,
    image,
    niirs,
    plan_mirrors,
    points,
    pulse,
    restore,
    scan,
    simulate,
    sites,
    star,
    study,
)
from acutance.cli.output import outputs_of_a_run
from acutance.cli.terminal import (
    BAD_USAGE,
    EXIT_CODES,
    INTERRUPTED,
    NOTHING_MEASURED,
    fail,
    log_said,
    replace_what_streams_lack,
    say,
    stop,
    stop_printing,
)
from acutance.errors import (
    AcutanceError,
    NoDataError,
    NothingSelectedError,
    OptionError,
    TargetError,
)
from acutance.targets.kinds import KINDS

__all__ = ["app", "run"]


class _Commands(TyperGroup):
    """Commands whose expected errors are one message on stderr and an exit code."""

    def make_context(self, *words: Any, **settings: Any) -> Any:
        # Help is printed while the words are read.
        with _stdout_needed():
            return super().make_context(*words, **settings)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        word = args[0]
        meant = [] if word in self.commands or ctx.resilient_parsing else self._meant_by(word)
        if meant:
            ctx.fail(f"No such command {word!r}. Did you mean {', '.join(map(repr, meant))}?")
        return super().resolve_command(ctx, args)

    def _meant_by(self, word: str) -> list[str]:
        """Commands that another word is used for, and those of this name in groups."""
        groups = {
            name: one.commands for name, one in self.commands.items() if hasattr(one, "commands")
        }
        inner = [f"{name} {word}" for name, commands in groups.items() if word in commands]
        return [*_ALSO_CALLED.get(word, ()), *inner]

    def invoke(self, ctx: Any) -> Any:
        try:
            with _stdout_needed(), outputs_of_a_run(), log_said():
                return super().invoke(ctx)
        except (TargetError, NoDataError, NothingSelectedError) as error:
            fail(str(error), NOTHING_MEASURED)
        except OptionError as error:
            fail(_as_typed(str(error), self.commands[ctx.invoked_subcommand]))
        except AcutanceError as error:
            fail(str(error))
        except MemoryError as error:
            fail(f"there is not enough memory ({error}): choose a smaller image or region")
        except KeyboardInterrupt as error:
            stop(str(error))
        except SystemError as error:
            from acutance.execution import was_interrupted

            if not was_interrupted(error):
                raise
            stop("")


class _Command(TyperCommand):
    """A command that refuses an option given twice, of which only the last would count."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        values, _, given = self.make_parser(ctx).parse_args(args=list(args))
        # A shell that completes the words is told nothing.
        for one, times in Counter(() if ctx.resilient_parsing else given).items():
            takes_one = isinstance(one, TyperOption) and not (one.multiple or one.is_flag)
            if takes_one and times > 1:
                raise OptionError(
                    f"{max(one.opts, key=len)} was given {times} times, and only the last would "
                    "count: give it once"
                )
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as error:
            found = None if error.param is None else values.get(error.param.name)
            kind = next((words for part, words in _NUMBERS.items() if part in error.message), None)
            if isinstance(found, str) and kind is not None:
                error.message = f"{found!r} is {kind}"
            raise


_ALSO_CALLED = {"pair": ("biresolution",), "mirrors": ("points",), "lamps": ("points",)}
"""What people and the package's rooms call a command besides its name."""
_NUMBERS = {"valid number": "no number", "valid integer": "no whole number"}
"""What typer says of numbers, without the text that was typed."""


def _as_typed(message: str, command: Any) -> str:
    """The message with the option as it is typed, where it begins with its name in Python."""
    # Where all options of a kind are checked alike, its name in Python goes before.
    found = re.match(r"(?:[A-Z]\w+: )?([a-z_]+) (?:is|has to be) ", message)
    if found is None:
        return message
    asked = f"--{found[1].replace('_', '-')}"
    # The names in Python end with the unit: --radius, radius_px.
    flags = [flag for flag in _flags(command) if f"{asked}-".startswith(f"{flag}-")]
    return f"{max(flags, key=len)}{message[found.end(1) :]}" if flags else message


def _flags(command: Any) -> Iterator[str]:
    """The options of a command and of those under it."""
    for parameter in command.params:
        yield from parameter.opts
    for one in getattr(command, "commands", {}).values():
        yield from _flags(one)


@contextmanager
def _stdout_needed() -> Iterator[None]:
    """End the program where stdout takes no more."""
    try:
        yield
    except OSError as error:
        # An error of a file names the file; one of a stream cannot.
        if isinstance(error, AcutanceError) or error.filename is not None:
            raise
        stop_printing(error)


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


@app.callback(help=f"Measure how sharp an Earth-observation satellite really sees.\n\n{EXIT_CODES}")
def _main(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    pass


for _name, _module, _words in (
    ("edge", edge, "Measure a straight edge."),
    ("pulse", pulse, "Measure a pulse: a tarp on grass, a bridge, a stripe."),
    ("points", points, "Measure points: mirrors, lamps, stars of the sky."),
    ("biresolution", biresolution, "Measure a sensor against a finer image."),
    ("bars", bars, "Measure groups of bars."),
    ("star", star, "Measure a Siemens star, full or a fan."),
    ("combine", combine, "Combine measurements of one sensor."),
    ("scan", scan, "Measure a sensor from all edges of a scene."),
    ("batch", batch, "Measure all targets of many images into an archive."),
    ("image", image, "Show what an image says of itself."),
    ("niirs", niirs, "Interpretability of an image (NIIRS)."),
    ("sites", sites, "List the edge targets that --site knows."),
    ("study", study, "Run a study of targets and estimators."),
    ("demo", demo, "Measure a simulated campaign by every method."),
):
    _measures = _name in KINDS or _name in ("batch", "combine", "scan")
    _epilog = f"{EXIT_CODES}\n\n{_module.EXAMPLE}" if _measures else _module.EXAMPLE
    app.command(_name, epilog=_epilog, short_help=_words)(getattr(_module, _name))
app.add_typer(archive.app, name="archive")
app.add_typer(restore.app, name="restore")
app.add_typer(simulate.app, name="simulate")
app.add_typer(plan_mirrors.app, name="plan")


def _commands_under(group: typer.Typer) -> Iterator[Any]:
    """Every command of a group and of those in it, as it was registered."""
    yield from group.registered_commands
    for one in group.registered_groups:
        if one.typer_instance is not None:
            yield from _commands_under(one.typer_instance)


for _info in _commands_under(app):
    _info.cls = _Command


def run() -> None:
    """Entry point of the command ``acutance``."""
    if sys.stdout is None:
        say("acutance: standard output is closed: send the result to a file")
        sys.exit(BAD_USAGE)
    replace_what_streams_lack()
    # A third of a second, for memory that the system takes back anyway.
    atexit.register(gc.freeze)
    try:
        app(prog_name="acutance")
    except KeyboardInterrupt:  # While the commands are built.
        say("acutance: interrupted")
        sys.exit(INTERRUPTED)
