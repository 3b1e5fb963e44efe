"""A section of the report from a user's own file."""

from __future__ import annotations

from pathlib import Path

import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError
from greybox_torch.report.page import render_page
from greybox_torch.report.pdf.document import render_pdf
from greybox_torch.report.pdf.own_sections import PICTURE
from greybox_torch.report.pdf.sheets import Sheets

SECTION = '''
import greybox_torch as gt


def maintenance(verdict, about):
    """What to look at on the machine; nothing where nothing is missing."""
    if not verdict.effects:
        return None
    return {"places": [effect.port for effect in verdict.effects], "dataset": verdict.dataset}


gt.register_section(
    "maintenance",
    maintenance,
    """<section id="maintenance"><h2>To look at</h2>
<p>{{ section.dataset }}: {{ section.places | map("words") | join(", ") }}</p></section>
""",
    before="scores",
)
'''


def test_it_stands_where_it_was_put(run_file, of_kind, about) -> None:
    without = render_page(of_kind("found"), about)
    run_file("maintenance.py", SECTION)
    page = render_page(of_kind("found"), about)
    assert "To look at</h2>" in page and "gear spring</p>" in page
    assert page.index('id="evidence"') < page.index('id="maintenance"') < page.index('id="fit"')
    gt.unregister_section("maintenance")
    assert render_page(of_kind("found"), about) == without


def test_none_leaves_it_out(run_file, of_kind, about) -> None:
    run_file("maintenance.py", SECTION)
    assert "To look at" not in render_page(of_kind("nothing"), about)


def test_values_are_escaped(run_file, of_kind, about) -> None:
    run_file("maintenance.py", SECTION.replace("verdict.dataset}", "'<script>'}"))
    page = render_page(of_kind("found"), about)
    assert "&lt;script&gt;: gear" in page


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("section.dataset", "section.data_set", "report section 'maintenance': its template: UndefinedError"),
        (
            "{{ section.dataset }}",
            "{{ section.dataset",
            "report section 'maintenance': its template: TemplateSyntaxError",
        ),
        ("effect.port for", "effect.place for", "report section 'maintenance': making it raised AttributeError"),
        ('"maintenance",', '"effects",', "name is 'effects'; expected a word that is none of effects, "),
        ('before="scores"', 'before="score"', "before is 'score'; expected one of headline, effects, "),
    ],
)
def test_what_is_wrong_is_said(run_file, of_kind, about, old: str, new: str, message: str) -> None:
    assert old in SECTION
    with pytest.raises(UserError) as refused:
        run_file("maintenance.py", SECTION.replace(old, new))
        render_page(of_kind("found"), about)
    assert message in str(refused.value)


def test_a_template_in_a_file_of_its_own(tmp_path: Path, run_file, of_kind, about) -> None:
    run_file("other.py", SECTION)
    file = tmp_path / "own.html.j2"
    with pytest.raises(UserError, match="no such file"):
        gt.register_section("own", lambda verdict, about: {}, file)
    file.write_text("<p>from a file</p>\n")
    gt.register_section("own", lambda verdict, about: {}, file)
    assert "<p>from a file</p>" in render_page(of_kind("found"), about)


def test_only_what_was_registered_is_taken_out() -> None:
    with pytest.raises(UserError, match="'effects' was not registered; registered are: none"):
        gt.unregister_section("effects")


def test_its_text_is_printed(of_kind, about, monkeypatch) -> None:
    told: list[str] = []
    write = Sheets.text
    monkeypatch.setattr(Sheets, "text", lambda self, text, *a, **k: (told.append(text), write(self, text, *a, **k))[1])
    table = "<table><tr><td>grease</td><td>{{ section.dataset }}</td></tr></table><svg><text>drawn</text></svg>"
    gt.register_section("maintenance", lambda verdict, about: {"dataset": "a & b"}, f"<h2>To do</h2>{table}")
    try:
        render_pdf(of_kind("found"), about)
    finally:
        gt.unregister_section("maintenance")
    assert "grease · a & b" in told and PICTURE in told
    assert "drawn" not in told
