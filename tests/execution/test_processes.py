"""Independent tasks in this process and in others: every result once, whatever happens."""

import os
import time

import pytest

from acutance.errors import AcutanceError, WorkerError
from acutance.execution import results_in_turn, run_tasks


def square(task):
    return task * task, os.getpid()


def fails_at_seven(task):
    if task == 7:
        raise ValueError("seven")
    # Long enough for this process to hear of the error on a busy machine.
    time.sleep(0.002)
    return task


def collected(work, tasks, workers):
    found = {}

    def keep(place, result):
        assert place not in found
        found[place] = result

    run_tasks(work, tasks, keep, workers=workers)
    return found


def interrupted_at_three(task):
    if task == 3:
        raise SystemError("a function returned a result with an error set") from KeyboardInterrupt()
    return task


def test_ctrl_c_inside_a_compiled_loop_is_ctrl_c():
    with pytest.raises(KeyboardInterrupt):
        collected(interrupted_at_three, range(5), 1)
    with pytest.raises(KeyboardInterrupt):
        list(results_in_turn(interrupted_at_three, range(5)))


@pytest.mark.parametrize("workers", [1, 2])
def test_every_result_is_handed_over_once_with_the_place_of_its_task(workers):
    tasks = list(range(40, 0, -1))
    found = collected(square, tasks, workers)
    assert {place: value for place, (value, _) in found.items()} == {
        place: task**2 for place, task in enumerate(tasks)
    }
    in_this_process = {process == os.getpid() for _, process in found.values()}
    assert in_this_process == {workers == 1}


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


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_in_the_order_of_the_tasks(workers):
    found = list(results_in_turn(square, range(100), workers=workers))
    assert [value for value, _ in found] == [task**2 for task in range(100)]
    assert len({process for _, process in found}) <= workers


def test_this_process_is_one_of_those_that_work_for_results_in_turn(tmp_path):
    # The first waits until two processes have begun one.
    found = set(results_in_turn(waits_for_company, [tmp_path] * 512, workers=2))
    assert len(found) == 2
    assert os.getpid() in found


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_comes_after_the_results_before_it(workers):
    results = results_in_turn(fails_at_seven, [1, 2, 3], workers=workers)
    assert list(results) == [1, 2, 3]
    with pytest.raises(ValueError, match="seven"):
        list(results_in_turn(fails_at_seven, [1, 7, 3], workers=workers))


def test_tasks_are_taken_as_they_are_needed_and_a_run_can_be_left():
    taken = []

    def tasks():
        for task in range(100_000):
            taken.append(task)
            yield task

    results = results_in_turn(square, tasks(), workers=2)
    assert next(results)[0] == 0
    results.close()
    assert len(taken) < 1000


def waits_for_company(folder):
    """The process of a task, which ends once another process has one, too."""
    (folder / str(os.getpid())).touch()
    until = time.monotonic() + 60
    while len(list(folder.iterdir())) < 2 and time.monotonic() < until:
        time.sleep(0.01)
    return os.getpid()


def test_few_long_tasks_occupy_all_processes(tmp_path):
    found = {}
    run_tasks(waits_for_company, [tmp_path] * 4, found.__setitem__, workers=2, chunk=1)
    assert len(set(found.values())) == 2
    assert set(found) == {0, 1, 2, 3}


def fails_or_takes_long(task):
    place, folder = task
    (folder / f"begun {place}").touch()
    if place == 0:
        while not (folder / "begun 1").exists():
            time.sleep(0.01)
        raise ValueError("zero")
    time.sleep(20)
    (folder / "finished").touch()


def test_a_task_that_takes_longer_than_a_user_waits_is_left(tmp_path):
    tasks = [(place, tmp_path) for place in range(3)]
    with pytest.raises(ValueError, match="zero"):
        run_tasks(fails_or_takes_long, tasks, lambda place, result: None, workers=2, chunk=1)
    found = {one.name for one in tmp_path.iterdir()}
    # The process that failed may take another task before it is told to stop.
    assert {"begun 0", "begun 1"} <= found <= {"begun 0", "begun 1", "begun 2"}


def killed(task):
    """Ends every process but that of the test, which waits for it."""
    here, begun = task
    if os.getpid() != here:
        begun.touch()
        os._exit(1)
    until = time.monotonic() + 60
    while not begun.exists() and time.monotonic() < until:
        time.sleep(0.01)


@pytest.mark.parametrize("all_elsewhere", [True, False])
def test_a_killed_process_is_an_error_that_says_what_to_do(tmp_path, all_elsewhere):
    tasks = [(os.getpid(), tmp_path / "begun")] * 100
    words = r"memory: use fewer .* goes on where it was"
    with pytest.raises(WorkerError, match=words) as found:
        _ = (
            run_tasks(killed, tasks, lambda place, result: None, workers=2)
            if all_elsewhere
            else list(results_in_turn(killed, tasks, workers=2))
        )
    assert isinstance(found.value, AcutanceError)


def killed_meanwhile(here):
    """Ends every process but that of the test, which goes on."""
    if os.getpid() != here:
        os._exit(1)
    time.sleep(0.0005)


def test_tasks_that_were_done_here_do_not_break_the_end_of_a_broken_pool():
    # Pytest reports what fails in another thread.
    with pytest.raises(WorkerError, match="killed"):
        list(results_in_turn(killed_meanwhile, [os.getpid()] * 20_000, workers=3))
