"""Independent tasks in this process and in others: every result once, whatever happens."""

import os

import pytest

from acutance.studies.execution import run_tasks


def square(task):
    return task * task


def fails_at_seven(task):
    if task == 7:
        raise ValueError("seven")
    return task


def process(task):
    return os.getpid()


def collected(work, tasks, workers):
    found = {}

    def keep(place, result):
        assert place not in found
        found[place] = result

    run_tasks(work, tasks, keep, workers=workers)
    return found


@pytest.mark.parametrize("workers", [1, 2])
def test_every_result_is_handed_over_once_with_the_place_of_its_task(workers):
    tasks = list(range(40, 0, -1))
    assert collected(square, tasks, workers) == {k: task**2 for k, task in enumerate(tasks)}


def test_one_worker_stays_in_this_process_and_several_are_others():
    assert set(collected(process, [1, 2, 3], 1).values()) == {os.getpid()}
    assert os.getpid() not in collected(process, [1, 2, 3], 2).values()


def test_no_tasks_start_nothing():
    assert collected(fails_at_seven, [], None) == {}


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_ends_the_run_and_keeps_what_was_finished(workers):
    found = {}
    with pytest.raises(ValueError, match="seven"):
        run_tasks(fails_at_seven, range(2000), found.__setitem__, workers=workers)
    assert all(place == result for place, result in found.items())
    assert 7 not in found
    assert 0 in found or workers == 2
    assert len(found) < 1900
