"""Drawings, one module a kind of target; `acutance.report.figure` puts them on one page.

A kind gives `Panel` objects (`panel.py`), listed in the one dict of `acutance.report.figure`.
`curves.py` draws what every measurement has (MTF, LSF, PSF), `pixels.py` images and residuals,
`writing.py` text in columns. `comparison.py` and `target.py` draw several measurements at once,
`campaign.py` a whole site.
"""
