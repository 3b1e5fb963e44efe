"""The sections of the page in their order, and the way to add one and to take it out again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.errors import UserError
from greybox_torch.report.about import About
from greybox_torch.report.sections.effects import Effects
from greybox_torch.report.sections.evidence import Evidence
from greybox_torch.report.sections.headline import Headline
from greybox_torch.report.sections.limits import Limits
from greybox_torch.report.sections.making import Making
from greybox_torch.report.sections.parameters import Parameters
from greybox_torch.report.sections.ranking import Ranking
from greybox_torch.report.sections.remains import Remains
from greybox_torch.report.sections.scores import Scores
from greybox_torch.report.sections.spectrum import Spectrum
from greybox_torch.report.sections.traces import Traces

MakeSection = Callable[[Verdict, About], Any]
"""Makes what a section's template prints (``section`` there) from the verdict and what is said of the run; None leaves it out."""

SECTIONS: dict[str, MakeSection] = {
    "headline": lambda verdict, about: Headline.of(verdict),
    "effects": lambda verdict, about: Effects.of(verdict),
    "evidence": lambda verdict, about: Evidence.of(verdict),
    "scores": Scores.of,
    "parameters": lambda verdict, about: Parameters.of(verdict),
    "remains": lambda verdict, about: Remains.of(verdict),
    "limits": lambda verdict, about: Limits.of(verdict),
    "traces": lambda verdict, about: Traces.of(verdict),
    "spectrum": lambda verdict, about: Spectrum.of(verdict),
    "ranking": lambda verdict, about: Ranking.of(verdict),
    "making": Making.of,
}
"""By name, from top to bottom: the verdict, what was found, the evidence, what it gains, how it was made."""

BUILT_IN = frozenset(SECTIONS)

TEMPLATES: dict[str, str] = {}
"""By name of a registered section, the text of its Jinja template."""


def register_section(name: str, make: MakeSection, template: str | Path, *, before: str = "making") -> None:
    """Print a section of one's own in every report.

    Args:
        make: from the verdict and what is said of the run, what the template prints as ``section``; None leaves the section out.
        template: a Jinja template of HTML, as text or as the path of a file. Values are escaped.
        before: the section that follows it.

    Raises:
        UserError: a section that came with the package has the name, there is no section ``before``, or no such file.
    """
    if name in BUILT_IN or not name.isidentifier():
        raise UserError(
            f"register_section: name is {name!r}; expected a word that is none of {', '.join(sorted(BUILT_IN))}"
        )
    others = {n: m for n, m in SECTIONS.items() if n != name}
    if before not in others:
        raise UserError(f"register_section: before is {before!r}; expected one of {', '.join(others)}")
    if isinstance(template, Path) and not template.is_file():
        raise UserError(f"register_section: template {template}: no such file")
    TEMPLATES[name] = template.read_text() if isinstance(template, Path) else template
    SECTIONS.clear()
    for other, entry in others.items():
        if other == before:
            SECTIONS[name] = make
        SECTIONS[other] = entry


def unregister_section(name: str) -> None:
    """Take a section of one's own out again. Raises UserError where there is none of that name, or where it came with the package."""
    if name not in TEMPLATES:
        raise UserError(
            f"unregister_section: '{name}' was not registered; registered are: {', '.join(TEMPLATES) or 'none'}"
        )
    del TEMPLATES[name], SECTIONS[name]
