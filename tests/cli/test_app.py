"""The command as a whole: help, version, errors, what it imports."""

import os
import shlex
import subprocess
import sys

import pytest
from typer.main import get_command

from acutance import __version__
from acutance.cli import app as app_module
from acutance.errors import ImageError

# Made once: it takes a tenth of a second or two.
WHOLE = get_command(app_module.app)
HEAVY = ("numpy", "scipy", "matplotlib", "rasterio", "jinja2", "rich", "pydantic")


def commands(command=None, words=()):
    """Every command and group of commands, with the words that call it."""
    command = WHOLE if command is None else command
    yield words, command
    for name, inner in getattr(command, "commands", {}).items():
        yield from commands(inner, (*words, name))


def examples(command):
    """Lines of a command's help below "Example:"."""
    lines = [line.strip() for line in (command.epilog or "").splitlines()]
    start = next(i for i, line in enumerate(lines) if line in ("Example:", "Examples:"))
    return lines[start + 1 :]


@pytest.mark.parametrize(
    ("words", "command"), [pytest.param(*one, id=" ".join(one[0])) for one in commands()]
)
def test_every_help_ends_with_examples_that_can_be_typed(acutance, words, command):
    shown = [line.strip() for line in acutance(*words, "--help").stdout.strip().splitlines()]
    typed = examples(command)
    assert shown[-len(typed) :] == typed
    assert shown[-len(typed) - 1] in ("Example:", "Examples:")
    assert any(" ".join(("acutance", *words)) in line for line in typed)
    for line in typed:
        program, *given = shlex.split(line.split(" > ")[0])
        assert program == "acutance"
        called = WHOLE
        while hasattr(called, "commands"):
            called = called.commands[given.pop(0)]
        # Parses the line, and refuses an option or an argument that the command does not have.
        called.make_context(called.name, given)


def test_the_version_is_printed_alone(acutance):
    result = acutance("--version")
    assert (result.exit_code, result.stdout) == (0, f"acutance {__version__}\n")


def test_python_m_acutance_is_the_same_command():
    done = subprocess.run(
        [sys.executable, "-m", "acutance", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"acutance {__version__}\n"


def printed_to(stdout, *words):
    """Exit code and stderr of a command whose stdout is a file descriptor."""
    done = subprocess.run(
        [sys.executable, "-m", "acutance", *words], stdout=stdout, stderr=subprocess.PIPE, text=True
    )
    return done.returncode, done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@pytest.mark.parametrize("words", [("sites", "--json"), ("--help",), ("edge", "--help")])
def test_a_full_stdout_is_one_line_and_exit_2(words):
    with open("/dev/full", "w") as full:
        code, said = printed_to(full, *words)
    assert code == 2
    assert said.startswith("acutance: the result cannot be written to standard output (No space")
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize("words", [("sites", "--json"), ("--help",)])
def test_a_reader_that_has_left_ends_the_command_without_a_word(words):
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as closed:
        assert printed_to(closed, *words) == (141, "")


def test_without_any_stdout_nothing_is_measured():
    done = subprocess.run(
        ["sh", "-c", f"'{sys.executable}' -m acutance sites >&-"], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr == "acutance: standard output is closed: send the result to a file\n"


def test_nothing_heavy_is_imported_before_a_command_runs():
    code = f"import acutance.cli.app, sys; print([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("words", [("nonsense",), ("edge",), ("edge", "--nonsense", "x.tif")])
def test_bad_usage_is_exit_2_with_a_message(acutance, words):
    result = acutance(*words)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("pair", "'biresolution', 'simulate pair'"),
        ("compare", "'archive compare'"),
        ("design", "'restore design'"),
        ("mirrors", "'points', 'plan mirrors'"),
        ("archve", "'archive'"),
    ],
)
def test_an_unknown_command_is_answered_by_what_may_be_meant(acutance, word, meant):
    done = acutance(word, "x.tif")
    assert done.exit_code == 2
    assert f"No such command '{word}'. Did you mean {meant}?" in done.stderr


def test_commands_that_other_words_stand_for_are_there():
    names = {words for words, _ in commands()}
    for word, meant in app_module._ALSO_CALLED.items():
        assert (word,) not in names
        assert all((one,) in names for one in meant)


def test_run_turns_an_error_into_one_message_without_a_traceback(monkeypatch, capsys):
    def broken(**_):
        raise ImageError("the disk is gone: bring it back")

    monkeypatch.setattr(sys, "argv", ["acutance", "sites"])
    monkeypatch.setattr("acutance.raster.sites", broken)
    with pytest.raises(SystemExit) as ended:
        app_module.run()
    assert ended.value.code == 2
    assert capsys.readouterr().err == "acutance: the disk is gone: bring it back\n"


def test_an_error_of_acutance_is_the_last_line_of_stderr(acutance):
    result = acutance("edge", "/nowhere/scene.tif")
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("acutance: /nowhere/scene.tif does not exist")
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize("words", ["", "interrupted: 3 of 9 trials are kept in t.jsonl"])
def test_ctrl_c_is_one_line_and_exit_130(acutance, monkeypatch, words):
    def broken(**_):
        raise KeyboardInterrupt(words)

    monkeypatch.setattr("acutance.raster.sites", broken)
    result = acutance("sites")
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr == f"acutance: {words or 'interrupted'}\n"


def test_ctrl_c_before_a_command_runs_is_one_line_too(monkeypatch, capsys):
    def broken(**_):
        raise KeyboardInterrupt

    monkeypatch.setattr(app_module, "app", broken)
    with pytest.raises(SystemExit) as ended:
        app_module.run()
    assert ended.value.code == 130
    assert capsys.readouterr().err == "acutance: interrupted\n"
