"""The report: one HTML file that needs nothing else, not even a network."""

from __future__ import annotations

from jinja2 import ChoiceLoader, DictLoader, Environment, PackageLoader, StrictUndefined, TemplateError

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.errors import UserError
from greybox_torch.report import text
from greybox_torch.report.about import About
from greybox_torch.report.sections.order import SECTIONS, TEMPLATES


def render_page(verdict: Verdict, about: About) -> str:
    """The page as HTML text, with its sections from top to bottom.

    Raises:
        UserError: a registered section cannot be made or printed.
    """
    environment = _environment()
    printed = [_printed(environment, name, verdict, about) for name in SECTIONS]
    page = environment.get_template("page.html.j2")
    live = any("data-lines=" in section for section in printed)
    return page.render(live=live, title=f"{verdict.dataset}: diagnosis", sections=printed, version=about.version)


def registered_sections(verdict: Verdict, about: About) -> list[str]:
    """The HTML of the sections that others have registered, from top to bottom. Raises UserError where one cannot be made or printed."""
    environment = _environment()
    return [_printed(environment, name, verdict, about) for name in SECTIONS if name in TEMPLATES]


def _printed(environment: Environment, name: str, verdict: Verdict, about: About) -> str:
    """The HTML of a section, empty where it has nothing to say."""
    if name not in TEMPLATES:
        section = SECTIONS[name](verdict, about)
        return "" if section is None else environment.get_template(section.template).render(section=section)
    try:
        section = SECTIONS[name](verdict, about)
        return "" if section is None else environment.get_template(_own(name)).render(section=section)
    except TemplateError as error:
        raise UserError(f"report section '{name}': its template: {type(error).__name__}: {error}") from None
    except Exception as error:
        raise UserError(f"report section '{name}': making it raised {type(error).__name__}: {error}") from None


def _own(name: str) -> str:
    """The name of a registered template, where it cannot hide one of the package."""
    return f"registered/{name}"


def _environment() -> Environment:
    environment = Environment(
        loader=ChoiceLoader(
            [
                PackageLoader("greybox_torch.report", "templates"),
                DictLoader({_own(name): template for name, template in TEMPLATES.items()}),
            ]
        ),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"words": text.words, "percent": text.percent, "prose": text.prose}
    return environment
