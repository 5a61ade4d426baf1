"""Ctrl-C inside a compiled loop ends a command as everywhere else."""

import numpy as np
import pytest


def interrupted(*_, **__):
    try:
        raise KeyboardInterrupt
    except KeyboardInterrupt as interrupt:
        raise SystemError("a function returned a result with an exception set") from interrupt


def broken(*_, **__):
    raise SystemError("something else")


@pytest.fixture
def image(tmp_path):
    path = tmp_path / "edge.npy"
    np.save(path, np.zeros((40, 40)))
    return path


def test_the_exit_code_is_that_of_ctrl_c(acutance, image, monkeypatch):
    monkeypatch.setattr("acutance.targets.straight.measure_edge", interrupted)
    done = acutance("edge", image)
    assert (done.exit_code, done.stderr.strip()) == (130, "acutance: interrupted")


def test_other_errors_of_the_interpreter_are_not_hidden(acutance, image, monkeypatch):
    monkeypatch.setattr("acutance.targets.straight.measure_edge", broken)
    done = acutance("edge", image)
    assert isinstance(done.exception, SystemError)
