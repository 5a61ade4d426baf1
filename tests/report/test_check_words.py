"""What checks found, in words and rounded numbers."""

from dataclasses import replace

import pytest

from acutance.report.check_words import (
    common_verdict,
    count_failed_checks,
    failed_by_check,
    write_found,
)
from acutance.targets.check import MAX_RATIO, answer


def test_failed_checks_are_counted(measurement, vague_measurement, target):
    assert count_failed_checks([measurement]) == "1 of 6 checks failed."
    assert count_failed_checks([vague_measurement]) == "No checks were made."
    assert count_failed_checks(target.measurements) == "4 of 24 checks failed."


@pytest.mark.parametrize(
    ("value", "limit", "shown"), [(19.97, 20.0, "19.97"), (19.9996, 20.0, "19.9996"), (7, 20, "7")]
)
def test_a_failed_check_is_not_rounded_to_its_limit(measurement, value, limit, shown):
    failed = answer("rows", value, "few rows", {"rows": limit})
    assert not failed.passed
    assert write_found(failed, 3) == shown
    (row,) = failed_by_check([replace(measurement, checks=(failed,))])
    assert row[1] == f"1 ({shown}); asked >= 20"


def test_a_check_that_passes_may_be_rounded_to_its_limit():
    assert write_found(answer("rows", 20.003, "rows", {"rows": 20.0}), 3) == "20"


def test_the_bound_of_ratios_is_no_number_that_was_found():
    assert write_found(answer("quantisation", MAX_RATIO, "fine", {}), 3) == "≥ 999"
    assert write_found(answer("uniformity_target", 998.7, "even", {}), 4) == "998.7"
    assert write_found(answer("rows", 999.0, "rows", {}), 3) == "999"


def test_several_targets_have_the_verdict_of_the_worst(measurement, target):
    words = ("good", "usable", "doubtful", "invalid")
    worst = max((one.verdict.word for one in target.measurements), key=words.index)
    assert common_verdict(target.measurements).word == worst
    clean = replace(measurement, checks=(answer("rows", 30.0, "rows", {}),))
    assert common_verdict([clean]).word == "good"
