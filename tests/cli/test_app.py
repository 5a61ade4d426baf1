"""The command as a whole: help, version, errors, what it imports."""

import subprocess
import sys

import pytest

from acutance import __version__
from acutance.cli import app as app_module
from acutance.errors import ImageError

HEAVY = ("numpy", "scipy", "matplotlib", "rasterio", "jinja2", "rich", "pydantic")


@pytest.mark.parametrize(
    "words", [(), ("edge",), ("pulse",), ("sites",), ("simulate",), ("simulate", "edge"), ("demo",)]
)
def test_every_help_ends_with_an_example(acutance, words):
    result = acutance(*words, "--help")
    assert result.exit_code == 0
    last = result.stdout.strip().splitlines()[-2:]
    assert last[0].strip() == "Example:"
    assert last[1].startswith("    acutance ")


def test_the_version_is_printed_alone(acutance):
    result = acutance("--version")
    assert (result.exit_code, result.stdout) == (0, f"acutance {__version__}\n")


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
