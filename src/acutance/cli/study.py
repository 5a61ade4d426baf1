"""``acutance study``: the studies that characterise targets and estimators."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin, get_type_hints

import typer

from acutance.cli.output import OutputFile, check_output, make_folder
from acutance.cli.progress import progress_bar
from acutance.cli.terminal import warnings_said
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.studies import Execution, StudyResult

__all__ = [
    "EXAMPLE",
    "WorkersOption",
    "dask_option",
    "execution_of",
    "study",
    "write_result",
]

EXAMPLE = "\b\nExample:\n  acutance study angle --out studies --set places=3"
STUDIES_HELP = "snr, ground-noise, angle, width, width-correction or all"

_KINDS = {int: "a whole number", float: "a number", tuple: "several numbers"}

WorkersOption = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="Processes; all cores if not given.")
]


def dask_option(seen: str) -> Any:
    """The option ``--dask``; `seen` is what its workers have to see."""
    return typer.Option(
        metavar="ADDRESS",
        help="Use the workers of this dask scheduler instead of processes: tcp://HOST:8786. "
        f"They have to see {seen}.",
    )


def study(
    name: Annotated[str, typer.Argument(metavar="NAME", help=f"{STUDIES_HELP}.")],
    out: Annotated[
        str | None,
        typer.Option(
            metavar="FOLDER",
            help="Write tables (CSV), document (JSON) and figure (PNG) here, and keep finished "
            "trials, so that an interrupted study goes on where it was.",
        ),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="OPTION=VALUE",
            help="Another value than the paper's, as draws=5; repeatable. An unknown option is "
            "answered with all there are.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")] = 2005,
    workers: WorkersOption = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the JSON document, and nothing else, to stdout.")
    ] = False,
) -> None:
    """Run a study of the pulse and edge methods, by the published estimator and by ours.

    Defaults are the parameters of the 2005 report on the generic sensor.
    """
    from acutance.studies import STUDIES, run_study

    if name == "plan":
        raise OptionError(
            "plan is a command of its own: acutance plan edge, pulse, mirrors or trend"
        )
    if name != "all" and name not in STUDIES:
        raise OptionError(f"there is no study {name!r}: the studies are {', '.join(STUDIES)}, all")
    if name == "all" and (changes or as_json):
        raise OptionError("--set and --json belong to one study: name it instead of all")
    wanted = list(STUDIES) if name == "all" else [name]
    options = {one: _options(STUDIES[one].options, changes or []) for one in wanted}
    folder = None if out is None else make_folder("--out", out)
    for one in wanted:
        with progress_bar(one) as progress, warnings_said():
            how = execution_of(seed, workers, folder, progress)
            result = run_study(one, options[one], how)
        _deliver(result, folder, as_json)


def execution_of(
    seed: int,
    workers: int | None,
    folder: Path | None,
    progress: Callable[[int, int], None] | None,
) -> Execution:
    """How the options of the command line want a study to be run."""
    from acutance.studies import Execution

    return Execution(seed=seed, workers=workers, folder=folder, progress=progress)


def _options(kind: type[Any], changes: Sequence[str]) -> Any:
    """The study's options, changed as every ``--set OPTION=VALUE`` asks."""
    options = kind()
    typed = _typed(options)
    seen: set[str] = set()
    for text in changes:
        option, _, value = text.partition("=")
        if option not in typed:
            raise OptionError(f"--set {text}: the options are {', '.join(sorted(typed))}")
        if option in seen:
            raise OptionError(f"--set {text}: {option} was set before: set it once")
        seen.add(option)
        chosen = _value(option, value, text)
        if option != "sensor":
            chosen = _checked(option, chosen, *typed[option])
        options = _with(options, option, chosen)
    return options


def _typed(options: Any, prefix: str = "") -> dict[str, tuple[Any, Any]]:
    """Type and default of every option that can be typed, as ``ground.variance`` those of one.

    Of several objects, as the cases of a table, none can be.
    """
    hints = get_type_hints(type(options))
    typed: dict[str, tuple[Any, Any]] = {}
    for field in fields(options):
        name, default = field.name, getattr(options, field.name)
        if is_dataclass(default) and name != "sensor":
            typed |= _typed(default, f"{prefix}{name}.")
        elif not (isinstance(default, tuple) and is_dataclass(default[0])):
            typed[f"{prefix}{name}"] = (hints[name], default)
    return typed


def _with(options: Any, option: str, value: Any) -> Any:
    """The options with another value of one, or of an option of one."""
    name, _, inner = option.partition(".")
    return replace(
        options, **{name: _with(getattr(options, name), inner, value) if inner else value}
    )


def _checked(option: str, value: Any, hint: Any, default: Any) -> Any:
    """A value of the type that an option has."""
    if isinstance(default, tuple):
        value = tuple(value) if isinstance(value, list | tuple) else (value,)
        if _fits((value,), hint):
            # A single pair of several.
            value = (value,)
    if _fits(value, hint):
        return float(value) if hint is float else value
    wanted = _KINDS.get(type(default), "of another kind")
    if isinstance(default, tuple) and Ellipsis not in get_args(hint):
        wanted = f"{len(get_args(hint))} numbers"
    example = f"{option}={_as_typed(default)}"
    if isinstance(default, tuple) and isinstance(default[0], tuple):
        # Shells read parentheses.
        wanted, example = "several pairs of numbers", f'"{example}"'
    raise OptionError(f"--set {option}={value}: {option} is {wanted}, as in {example}")


def _fits(value: Any, hint: Any) -> bool:
    """Whether a value is a number, or a tuple of values, as an option's annotation asks."""
    if get_origin(hint) is not tuple:
        accepted = (int, float) if hint is float else hint
        return isinstance(value, accepted) and not isinstance(value, bool)
    hints = get_args(hint)
    if Ellipsis in hints:
        hints = hints[:1] * len(value) if isinstance(value, tuple) else ()
    return isinstance(value, tuple) and len(value) == len(hints) and all(map(_fits, value, hints))


def _as_typed(default: Any) -> str:
    """A default as it is written behind ``--set``; the first of many."""
    if isinstance(default, tuple):
        return ",".join(map(str, default[:3]))
    return str(default)


def _value(option: str, value: str, text: str) -> Any:
    if option == "sensor":
        from acutance.cli.sensor import named_sensor

        return named_sensor(value)
    try:
        return ast.literal_eval(value)
    except (ValueError, SyntaxError) as error:
        raise OptionError(
            f"--set {text}: write a number or several with commas, as in {option}=1,2"
        ) from error


def _deliver(result: StudyResult, folder: Path | None, as_json: bool) -> None:
    from acutance.report import json_text, study_text

    if folder is not None:
        write_result(result, folder)
    typer.echo(json_text(result.to_dict()) if as_json else study_text(result))


def write_result(result: StudyResult, folder: Path) -> None:
    """Tables as CSV, everything as JSON, and the figure."""
    from acutance.report import figure_bytes, json_text, study_figure

    def named(ending: str) -> OutputFile:
        name = folder / f"{result.name}{ending}"
        return check_output("--out", str(name), (name.suffix,))

    files: dict[str, str | bytes] = {
        ".csv" if name == result.name else f"-{name}.csv": table.to_csv()
        for name, table in result.tables.items()
    }
    files[".json"] = json_text(result.to_dict())
    files[".png"] = figure_bytes(study_figure(result), ".png")
    for ending, content in files.items():
        named(ending).deliver(content)
