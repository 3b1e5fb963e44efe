"""The report: one HTML file that needs nothing else, not even a network."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, StrictUndefined

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text
from greybox_torch.report.about import About
from greybox_torch.report.sections.effects import Effects
from greybox_torch.report.sections.evidence import Evidence
from greybox_torch.report.sections.headline import Headline
from greybox_torch.report.sections.limits import Limits
from greybox_torch.report.sections.making import Making
from greybox_torch.report.sections.ranking import Ranking
from greybox_torch.report.sections.scores import Scores
from greybox_torch.report.sections.spectrum import Spectrum
from greybox_torch.report.sections.traces import Traces


def render_page(verdict: Verdict, about: About) -> str:
    """The page as HTML text, from top to bottom: the verdict, what was found, the evidence, what it gains, how it was made."""
    sections = (
        Headline.of(verdict),
        Effects.of(verdict),
        Evidence.of(verdict),
        Scores.of(verdict, about),
        Limits.of(verdict),
        Traces.of(verdict),
        Spectrum.of(verdict),
        Ranking.of(verdict),
        Making.of(verdict, about),
    )
    page = _environment().get_template("page.html.j2")
    return page.render(
        title=f"{verdict.dataset}: diagnosis", sections=[s for s in sections if s is not None], version=about.version
    )


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("greybox_torch.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"words": text.words, "percent": text.percent}
    return environment
