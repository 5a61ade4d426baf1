"""The questions asked of an archive: means, trends, specifications, comparisons, tables."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Unpack

from acutance.archive.comparison_margin import MARGIN
from acutance.archive.connection import Database
from acutance.archive.measurements import Measurements
from acutance.archive.selection import Selection, SelectionWords
from acutance.arguments import require_kind

if TYPE_CHECKING:
    from acutance.archive.comparisons import GroupComparison
    from acutance.archive.requirement_answers import SpecificationCheck
    from acutance.archive.specification import Specification
    from acutance.archive.tables_by import MeasurementTable
    from acutance.archive.trends import Event, Series, Trend
    from acutance.archive.weighted_means import WeightedMean

__all__ = ["Questions"]

_VERDICT = "usable"


class Questions(ABC):
    """Questions to whatever has measurements as columns.

    Measurements count that are usable or good; ``verdict="doubtful"`` takes more.
    """

    _database: Database

    @abstractmethod
    def measurements(self, **selection: Unpack[SelectionWords]) -> Measurements:
        """Measurements as columns."""

    def require_known_names(self, selection: SelectionWords) -> None:
        """Refuse filters by names that occur nowhere, all of them at once, and an empty archive.

        Parameters
        ----------
        selection : mapping
            Filters, as of `measurements`.

        Raises
        ------
        NothingSelectedError
            Tells the names that occur, or that there is nothing at all.
        """
        from acutance.archive.known_names import require_known_names

        require_kind(Mapping, selection=selection)
        require_known_names(self._database, Selection.of(selection))

    def series(self, metric: str, **selection: Unpack[SelectionWords]) -> Series:
        """One metric of one sensor, band and direction through time.

        Parameters
        ----------
        metric : str
            "mtf_nyquist".
        **selection
            Filters, as of `measurements`.

        Raises
        ------
        OptionError
            If nothing is selected, or several sensors, bands, levels or directions are.
        """
        from acutance.archive.trends.measured_series import one_series

        return one_series(self._trusted(selection), metric)

    def mean(self, metric: str, **selection: Unpack[SelectionWords]) -> WeightedMean:
        """The mean over images, with their scatter as a component of its own.

        Parameters
        ----------
        metric : str
        **selection
            Filters, as of `measurements`.
        """
        from acutance.archive.mean_of_images import mean_of_images

        return mean_of_images(self.series(metric, **selection))

    def trend(
        self, metric: str, *, events: Sequence[Event] = (), **selection: Unpack[SelectionWords]
    ) -> Trend:
        """Level, drift, steps, season and scatter of one metric.

        Parameters
        ----------
        metric : str
            "mtf_nyquist".
        events : sequence of Event, optional
            Dates at which the sensor may have changed.
        **selection
            Filters, as of `measurements`.

        Returns
        -------
        Trend

        Raises
        ------
        OptionError
            If nothing is selected, or several sensors, bands, levels or directions are; if fewer
            than three images have dates, or all are of one day.
        """
        from acutance.archive.trends import fit_trend

        return fit_trend(self.series(metric, **selection), events)

    def check(
        self,
        specification: Specification | str | os.PathLike[str],
        *,
        events: Sequence[Event] = (),
        **selection: Unpack[SelectionWords],
    ) -> SpecificationCheck:
        """Whether the sensors meet a specification.

        Parameters
        ----------
        specification : Specification or path
            A file in TOML, see `acutance.archive.specification`.
        events : sequence of Event, optional
            Dates at which the sensors may have changed.
        **selection
            Filters, as of `measurements`; those of a requirement go before them.

        Returns
        -------
        SpecificationCheck

        Raises
        ------
        NothingSelectedError
            If no requirement can be judged, because sensors, bands, sites or other names in each
            of them occur nowhere. Where others can, the answer to one with such a name tells it.
        OptionError
            If there is no specification, or it cannot be read.
        """
        from acutance.archive.known_names import unknown_names
        from acutance.archive.specification import Specification, read_specification
        from acutance.archive.specification_check import check_specification

        if not isinstance(specification, Specification):
            specification = read_specification(specification)
        return check_specification(
            specification,
            lambda words: self.measurements(**words),
            events,
            selection=selection,
            unknown=lambda words: unknown_names(self._database, Selection.of(words)),
        )

    def compare(
        self,
        metric: str = "mtf_nyquist",
        by: str = "orientation",
        *,
        margin: float = MARGIN,
        **selection: Unpack[SelectionWords],
    ) -> GroupComparison:
        """Whether across and along differ, or methods, kinds, bands agree.

        Groups that were measured in the same images are compared there, so that what an image does
        to both cancels; others by their means, with a drift of the sensor allowed for.

        Parameters
        ----------
        metric : str, optional
        by : {"orientation", "method", "kind", "band", "level", "sensor", "site", "target"}
            What is compared; sensors, bands, product levels and directions are not mixed else.
        margin : float, optional
            Relative difference below which groups are said to agree.
        **selection
            Filters, as of `measurements`.

        Returns
        -------
        GroupComparison
        """
        from acutance.archive.comparisons import compare_groups

        return compare_groups(self._trusted(selection), metric, by, margin=margin)

    def table(
        self,
        by: Sequence[str] = ("site", "date"),
        metrics: Sequence[str] = ("rer", "fwhm_px", "mtf_nyquist"),
        **selection: Unpack[SelectionWords],
    ) -> MeasurementTable:
        """Means across and along, by sensor, band, site, date.

        Parameters
        ----------
        by : sequence of str, optional
            Of `acutance.archive.tables_by.GROUPS`.
        metrics : sequence of str, optional
        **selection
            Filters, as of `measurements`.

        Returns
        -------
        MeasurementTable
        """
        from acutance.archive.tables_by import table_by

        return table_by(self._trusted(selection), by, metrics)

    def _trusted(self, selection: SelectionWords) -> Measurements:
        if selection.get("verdict") is None:
            selection = {**selection, "verdict": _VERDICT}
        found = self.measurements(**selection)
        if not len(found):
            self.require_known_names(selection)
        return found
