"""What long commands show: a line now and then where stderr is no terminal, and Ctrl-C."""

import os
import signal

import pytest

from acutance.cli import progress


def test_lines_come_no_more_often_than_they_may(capsys, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    with progress.progress_bar("batch") as show:
        for done in range(5):
            now[0] += 4
            show(done, 20)
        now[0] += 30
        show(5, None)
    assert capsys.readouterr().err.splitlines() == ["batch: 2 of 20", "batch: 5"]


def test_lines_have_what_was_found(capsys, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    with progress.progress_bar("scan") as show:
        now[0] += 30
        show.tell("12 edges")
        show(5, 9)
    assert capsys.readouterr().err == "scan: 5 of 9 (12 edges)\n"


def test_a_bar_has_what_was_found(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress.progress_bar("scan") as show:
        show.tell("12 edges, 7 to be used")
        show(5, 9)
    said = capsys.readouterr().err
    assert "5/9" in said
    assert "12 edges, 7 to be used" in said


def test_ctrl_c_is_answered_at_once(capsys):
    usual = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt), progress.progress_bar("batch"):
            os.kill(os.getpid(), signal.SIGINT)
        assert capsys.readouterr().err == "stopping ...\n"
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, usual)
