"""Work in steps, taken together."""

import pytest

from acutance.targets.steps import finished, stacks, together


def counted(name, count, taken):
    for step in range(count):
        taken.append((name, step))
        yield
    return name * count


def test_every_step_is_taken_by_all_before_the_next_and_results_keep_their_order():
    taken = []
    found = together([counted("a", 2, taken), counted("b", 0, taken), counted("c", 3, taken)])
    assert found == ["aa", "", "ccc"]
    assert taken == [("a", 0), ("c", 0), ("a", 1), ("c", 1), ("c", 2)]


def test_steps_alone_give_their_result():
    assert finished(counted("a", 4, [])) == "aaaa"
    assert together([]) == []


def test_stacks_grow_to_eight_regions_and_lose_none():
    found = list(stacks(range(25), first=1))
    assert [len(some) for some in found] == [1, 2, 4, 8, 8, 2]
    assert [one for some in found for one in some] == list(range(25))
    assert [len(some) for some in stacks(range(9))] == [8, 1]


def test_an_error_of_a_step_is_raised():
    def fails():
        yield
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        finished(fails())
