"""Linear algebra keeps to one thread while a fit runs, and no longer."""

from threadpoolctl import threadpool_info

from acutance.numerics.one_thread import one_thread


def threads():
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


def test_threads_are_one_inside_and_as_before_outside():
    before = threads()
    inside = one_thread(threads)()
    assert inside == [1] * len(before)
    assert threads() == before


def test_the_function_keeps_its_name_and_its_errors():
    @one_thread
    def divide(a: float, b: float = 0.0) -> float:
        """Divide."""
        return a / b

    assert divide.__name__ == "divide"
    assert divide.__doc__ == "Divide."
    assert divide(4.0, b=2.0) == 2.0
