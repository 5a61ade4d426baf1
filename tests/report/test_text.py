"""The report for a terminal."""

from acutance.report import comparison_text, target_text, text_report


def test_the_text_holds_every_number_and_check(measurement):
    text = text_report(measurement)
    for name, number in measurement.metrics().items():
        assert str(number).split(" ± ")[0] in text, name
    for check in measurement.checks:
        assert check.name in text
        assert check.limit in text
    assert "FAILED  plateau_px" in text
    assert "use a wider region" in text
    assert "scene.tif, band 1, rows 100–139, columns 260–295" in text


def test_the_text_of_a_pulse_has_its_width_and_levels(pulse, make_pulse):
    text = text_report(pulse)
    assert text.startswith("pulse by spline, across")
    assert "1208 on 203" in text
    assert "3.1530" in next(line for line in text.splitlines() if line.startswith("  Width "))
    both = comparison_text([pulse, make_pulse(method="sdsu-2005", width_std=0.0)])
    assert both.startswith("pulse by 2 methods")
    assert next(line for line in both.splitlines() if "Width [px]" in line).count("±") == 1


def test_columns_are_aligned(measurement):
    lines = text_report(measurement).splitlines()
    header = next(line for line in lines if "95 % interval" in line)
    end = header.index("std") + 3
    rows = lines[lines.index(header) + 1 :][: len(measurement.metrics())]
    assert {row[end - 1].isdigit() and row[end : end + 2] == "  " for row in rows} == {True}


def test_an_undefined_number_and_a_missing_gsd_are_said(vague_measurement):
    text = text_report(vague_measurement)
    assert "undefined" in next(line for line in text.splitlines() if "MTF30" in line)
    assert "array in memory" in text
    assert "GSD" not in text
    assert "No checks were made." in text


def test_a_comparison_has_a_column_for_each_method(compared):
    text = comparison_text(compared)
    assert "spline" in text
    assert "iso12233" in text
    row = next(line for line in text.splitlines() if "MTF at Nyquist" in line)
    assert row.count("±") == 3


def test_a_comparison_says_what_the_failed_checks_of_each_method_say(compared):
    lines = comparison_text(compared).splitlines()
    for one in compared:
        (verdict,) = (i for i, line in enumerate(lines) if line.startswith(f"{one.method}: "))
        (failed,) = one.failed_checks
        assert lines[verdict + 1] == f"  {failed.name}: {failed.message}"


def test_a_target_lists_edges_means_and_rejections(target):
    text = target_text(target)
    assert text.startswith("4 edges measured, 1 rejected")
    assert sum("plateau_px" in line for line in text.splitlines()) == 4
    assert "phases: <aligned> with the grid" in text
    scatter = target.groups["along"].chi_square["mtf_nyquist"]
    assert f"{scatter:.1f} / 1" in text
