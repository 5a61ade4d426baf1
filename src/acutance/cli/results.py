"""What becomes of results: files found writable before the work, then text or JSON on stdout."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import typer

from acutance.cli.options import ResultOptions
from acutance.cli.output import OutputFile, check_optional, check_output
from acutance.cli.terminal import FAILED_CHECK, command_line, say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.report import Comparison
    from acutance.targets import Measurement, TargetResult, ToleranceLimit

__all__ = ["Outputs", "Shown"]


@dataclass(frozen=True)
class Shown:
    """A result to be shown.

    Parameters
    ----------
    result : Measurement, Comparison or TargetResult
        Of one method, of several to be compared, or of all edges of a target.
    drawn_on : mapping
        What `acutance.report` needs besides to draw it: the pixels of a target, and their place.
    """

    result: Measurement | Comparison | TargetResult[Measurement]
    drawn_on: Mapping[str, Any] = field(default_factory=dict)

    @property
    def measurements(self) -> Sequence[Measurement]:
        """All measurements of the result."""
        from acutance.targets import Measurement

        return [self.result] if isinstance(self.result, Measurement) else self.result.measurements

    @property
    def methods_missing(self) -> int:
        """By how many of the methods compared the target could not be measured."""
        from acutance.report import Comparison

        return len(self.result.rejected) if isinstance(self.result, Comparison) else 0


@dataclass(frozen=True)
class Outputs:
    """Where results go.

    Parameters
    ----------
    figure, panels, report, csv : OutputFile or None
        The panels are files of their own, named after this one.
    inputs : tuple of str or None
        What the command reads: no output may overwrite a file of them.
    as_json, covariance, strict : bool
    required : tuple of ToleranceLimit
        Requirements to be answered.
    """

    figure: OutputFile | None
    panels: OutputFile | None
    report: OutputFile | None
    csv: OutputFile | None
    inputs: tuple[str | None, ...]
    as_json: bool
    covariance: bool
    strict: bool
    required: tuple[ToleranceLimit, ...]

    @classmethod
    def checked(cls, options: ResultOptions, inputs: Iterable[str | None]) -> Outputs:
        """The outputs of the options, found possible before any work is done for them.

        Parameters
        ----------
        options : ResultOptions
        inputs : iterable of str or None
            What the command reads, files or not: no output may overwrite a file of them.

        Raises
        ------
        OptionError
            If a file cannot be written, or the options contradict each other.
        """
        if options.covariance and not options.as_json:
            raise OptionError("--covariance belongs to the JSON document: add --json")
        from acutance.report.paper import FIGURE_ENDINGS

        kept = tuple(inputs)
        return cls(
            check_optional("--figure", options.figure, FIGURE_ENDINGS, keep=kept),
            check_optional("--panels", options.panels, FIGURE_ENDINGS, keep=kept),
            check_optional("--report", options.report, (".html",), keep=kept),
            check_optional("--csv", options.csv, (".csv",), keep=kept),
            kept, options.as_json, options.covariance, options.strict, options.required,
        )  # fmt: skip

    def of_regions(self, names: Sequence[str]) -> list[Outputs]:
        """Outputs of several regions: files that carry the region's name, "edge-north.png".

        Raises
        ------
        OptionError
            If a file cannot be written.
        """

        def named(output: OutputFile | None, stem: str) -> OutputFile | None:
            return None if output is None else _beside(output, stem, self.inputs)

        return [
            replace(
                self,
                figure=named(self.figure, stem),
                panels=named(self.panels, stem),
                report=named(self.report, stem),
                csv=named(self.csv, stem),
            )
            for stem in _file_names(names)
        ]

    def deliver(self, shown: Shown, marks: Mapping[str, Any] | None = None) -> None:
        """Write and print one result; under ``--strict`` a failed check is exit code 3.

        The document is marked with what it is of: its region.
        """
        from acutance import report

        self.write_files(shown)
        if self.as_json:
            typer.echo(report.json_text({**(marks or {}), **self.document(shown)}))
        else:
            typer.echo(report.text(shown.result, required=self.required))
        self.require_checks([shown])

    def document(self, shown: Shown) -> dict[str, Any]:
        """A result as a document, with what was asked for."""
        from acutance import report

        return report.document(shown.result, self.covariance, required=self.required)

    def write_files(self, shown: Shown) -> None:
        """Write the files that were asked for."""
        from acutance import report

        if self.figure is not None:
            figure = report.draw(shown.result, **shown.drawn_on)
            self.figure.deliver(report.figure_bytes(figure, self.figure.ending))
        if self.panels is not None:
            _write_panels(self.panels, shown, self.inputs)
        if self.report is not None:
            page = report.page(
                shown.result, command=command_line(), required=self.required, **shown.drawn_on
            )
            self.report.deliver(page)
        if self.csv is not None:
            self.csv.deliver(report.csv(shown.result))

    def write_rejection(self, what: str, reason: str) -> None:
        """Write a page in the place of a result that there is none of, if pages were asked for."""
        from acutance import report

        if self.report is not None:
            self.report.deliver(report.rejection_page(what, reason, command=command_line()))

    def require_checks(self, results: Iterable[Shown], missing: int = 0) -> None:
        """End with exit code 3 where ``--strict`` asks for more than there is."""
        if not self.strict:
            return
        shown_results = list(results)
        missing += sum(shown.methods_missing for shown in shown_results)
        measurements = [one for shown in shown_results for one in shown.measurements]
        failed = sum(not one.trusted for one in measurements)
        unmet = self._unmet(shown_results)
        if failed:
            say(f"acutance: a check failed in {failed} of {len(measurements)} measurements")
        if unmet:
            some = "1 requirement is" if unmet == 1 else f"{unmet} requirements are"
            say(f"acutance: {some} not met, or cannot be told yet")
        if failed or missing or unmet:
            raise typer.Exit(FAILED_CHECK)

    def _unmet(self, results: Iterable[Shown]) -> int:
        """How many requirements of all results are not met, or cannot be told yet."""
        from acutance.report.requirements import answers_to
        from acutance.targets.conformity import MET

        answers = (
            answer for shown in results for _, answer in answers_to(shown.result, self.required)
        )
        return sum(answer.word != MET for answer in answers)


def _write_panels(output: OutputFile, shown: Shown, inputs: tuple[str | None, ...]) -> None:
    """Every drawing of every measurement in a file of its own; those of several are numbered."""
    from acutance import report

    backdrop = shown.drawn_on.get("backdrop") if shown.measurements == [shown.result] else None
    for number, measurement in enumerate(shown.measurements, start=1):
        which = f"{number}-" if len(shown.measurements) > 1 else ""
        for panel in report.panels(measurement, backdrop=backdrop):
            one = _beside(output, f"{which}{panel.name}", inputs)
            one.deliver(report.figure_bytes(report.panel_figure(panel), one.ending))


def _beside(output: OutputFile, stem: str, inputs: tuple[str | None, ...]) -> OutputFile:
    """The file named after another and what is in it, "edge-north.png"."""
    path = output.path
    name = str(path.with_name(f"{path.stem}-{stem}{path.suffix}"))
    return check_output(output.option, name, (output.ending,), keep=inputs)


def _file_names(names: Sequence[str]) -> list[str]:
    """The names of regions as parts of file names, all different."""
    stems = [re.sub(r"[^\w.-]+", "-", name).strip("-") for name in names]
    if len(set(stems)) == len(stems):
        return stems
    return [f"{number}-{stem}" for number, stem in enumerate(stems, start=1)]
