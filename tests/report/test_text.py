"""Results as text for a terminal."""

from acutance.report import text


def test_the_text_holds_every_number_and_check(measurement):
    shown = text(measurement)
    for name, number in measurement.metrics().items():
        assert str(number).split(" ± ")[0] in shown, name
    for check in measurement.checks:
        assert check.name in shown
        assert check.asked in shown
    assert "CAUTION  blur_uniformity" in shown
    assert "doubtful: 1 of 6 checks failed." in shown
    assert (
        "blur_uniformity (caution): from part to part the blur changes by 8 %: another edge"
        in shown
    )
    assert "scene.tif, band 1, rows 100–139, columns 260–295" in shown
    assert "measured 2026-01-02 03:04 UTC" in shown


def test_the_verdict_stands_before_the_numbers(measurement, target):
    head, verdict, numbers, *_ = text(measurement).split("\n\n")
    assert "scene.tif" in head
    assert verdict == f"doubtful: {measurement.verdict.sentence}"
    assert "MTF at Nyquist" in numbers
    head, verdict, *_, failed = text(target).split("\n\n")
    assert verdict == "doubtful: 4 of 24 checks failed."
    assert failed.startswith("Failed checks\n  blur_uniformity, edges 1 ")


def test_the_text_of_a_pulse_has_its_width_and_levels(pulse, make_pulse):
    shown = text(pulse)
    assert shown.startswith("Pulse, method spline: across track")
    assert "1208 DN on a background of 203 DN" in shown
    assert "3.1530" in next(line for line in shown.splitlines() if line.startswith("  Width "))
    both = text([pulse, make_pulse(method="sdsu-2005", width_std=0.0)])
    assert both.startswith("Pulse by 2 methods, across track")
    assert next(line for line in both.splitlines() if "Width [px]" in line).count("±") == 1


def test_columns_are_aligned(measurement):
    lines = text(measurement).splitlines()
    header = next(line for line in lines if "95 % interval" in line)
    end = header.index("std") + 3
    rows = lines[lines.index(header) + 1 :][: len(measurement.metrics())]
    assert {row[end - 1].isdigit() and row[end : end + 2] == "  " for row in rows} == {True}


def test_an_undefined_number_and_a_missing_gsd_are_said(vague_measurement):
    shown = text(vague_measurement)
    assert "undefined" in next(line for line in shown.splitlines() if "MTF30" in line)
    assert "array in memory" in shown
    assert "GSD" not in shown
    assert "No checks were made." in shown


def test_a_comparison_has_a_column_for_each_method(compared):
    shown = text(compared)
    assert "spline" in shown
    assert "iso12233" in shown
    row = next(line for line in shown.splitlines() if "MTF at Nyquist" in line)
    assert row.count("±") == 3


def test_a_comparison_says_what_the_failed_checks_of_each_method_say(compared):
    lines = text(compared).splitlines()
    for one in compared:
        (verdict,) = (i for i, line in enumerate(lines) if line.startswith(f"{one.method}: "))
        (failed,) = one.failed_checks
        assert lines[verdict] == f"{one.method}: doubtful: 1 of 6 checks failed."
        assert lines[verdict + 1] == f"  {failed.name} ({failed.severity}): {failed.message}"


def test_a_target_lists_edges_means_rejections_and_what_failed(target):
    shown = text(target)
    assert shown.startswith("4 edges measured, 1 rejected")
    assert "blur_uniformity, edges 1 (0.08), 2 (0.08), 3 (0.08), 4 (0.08); asked <= 0.05: " in shown
    assert "\ndoubtful: 4 of 24 checks failed.\n" in shown
    line = target.measurements[1].line
    row = next(one for one in shown.splitlines() if one.split()[:1] == ["2"])
    assert row.split()[1:3] == [f"{line.row:.0f}", f"{line.col:.0f}"]
    assert row.endswith("doubtful  blur_uniformity")
    assert "phases  <aligned> with the grid" in shown
    scatter = target.groups["along"].chi_square["mtf_nyquist"]
    assert f"{scatter:.1f} / 1" in shown
