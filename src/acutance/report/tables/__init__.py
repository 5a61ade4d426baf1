"""Tables of results; what a page, a text and `acutance.report.tables` show is made here once.

`measurement.py` has the numbers, checks and options that every measurement has; each kind of
target adds its own (`points.py`, `star.py` ...), listed in the one dict of `result.py`.
`comparison.py` and `target.py` tabulate several measurements, `campaign.py` a whole site.
"""
