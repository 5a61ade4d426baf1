"""Tables of results as Markdown and LaTeX."""

import numpy as np

import acutance as ac
from acutance.report.html import Table

ODD = Table(
    ("Metric", "Value ± std", "95 % interval"),
    (("MTF_50 & more\nexplained", "0.28 ± 0.01", "0.26 … 0.30"), ("a|b", "< 0.1 %", "−3 – 5°")),
    "lrr",
    title="Numbers",
)


def test_markdown_has_a_row_of_every_row_and_no_line_within_a_cell():
    assert ODD.to_markdown().splitlines() == [
        "**Numbers**",
        "",
        "| Metric | Value ± std | 95 % interval |",
        "| :--- | ---: | ---: |",
        "| MTF_50 & more | 0.28 ± 0.01 | 0.26 … 0.30 |",
        "| a\\|b | < 0.1 % | −3 – 5° |",
    ]


def test_latex_escapes_what_it_would_read_otherwise():
    lines = ODD.to_latex().splitlines()
    assert lines[0] == r"\begin{tabular}{lrr}"
    assert lines[2] == r"Metric & Value $\pm$ std & 95 \% interval \\"
    assert lines[4] == r"MTF\_50 \& more & 0.28 $\pm$ 0.01 & 0.26 \ldots{} 0.30 \\"
    assert lines[5] == r"a|b & $<$ 0.1 \% & $-$3 -- 5$^\circ$ \\"
    assert lines[-1] == r"\end{tabular}"


def test_every_table_of_a_measurement_is_plain_latex():
    image, _ = ac.simulate.edge(
        ac.simulate.reference_systems()["gaussian"], snr=80, rng=np.random.default_rng(1)
    )
    for table in ac.report.tables(ac.measure_edge(image, gsd_m=0.7)):
        text = table.to_latex()
        assert text.isascii(), [one for one in text if not one.isascii()]
        assert text.count(r"\\") == 1 + len(table.rows)
        assert all(
            line.count(" & ") == len(table.columns) - 1
            for line in text.splitlines()
            if line.endswith(r"\\")
        )
