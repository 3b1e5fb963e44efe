"""The parts of the site that are written from the code, and links of the pages; the site itself is built by `make docs`."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from documentation import card_fields, command_line, gallery, settings_table
from documentation.__main__ import main
from documentation.law_picture import force_over_signal
from documentation.linked_files import linked_files, links, links_within_the_site
from documentation.written import WRITTEN
from greybox_torch.data.card import Card
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.library import BUILT_IN, LIBRARY
from tests.documentation.pages import PAGES, ROOT

NAVIGATION = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_to_files(page: str) -> None:
    for target in links(PAGES[page].read_text(encoding="utf-8")):
        assert (PAGES[page].parent / target).exists(), target


def test_every_page_is_in_the_navigation() -> None:
    named = set(re.findall(r"[\w/]+\.md$", NAVIGATION, re.M))
    assert named == {page.removeprefix("docs/") for page in PAGES if page.startswith("docs/")}


@pytest.mark.parametrize("place", WRITTEN)
def test_a_reader_of_the_clone_is_told_how_to_get_what_is_written(
    place: str, capsys: pytest.CaptureFixture[str]
) -> None:
    told, name = PAGES[f"docs/{place}"].read_text(encoding="utf-8"), Path(place).stem
    assert "`make docs`" in told and f"`python -m documentation {name}`" in told
    assert main([name]) == 0 and capsys.readouterr().out == f"{WRITTEN[place]()}\n"
    assert told.splitlines()[0] == WRITTEN[place]().splitlines()[0]


def test_a_page_that_nothing_writes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["laws"]) == 2 and "found laws, expected of command_line, card_fields" in capsys.readouterr().err


def test_files_elsewhere_are_taken_along() -> None:
    found = {path.relative_to(ROOT).as_posix() for path in linked_files(ROOT / "docs", ROOT)}
    assert {"experiments/concealed/README.md", "experiments/speed/measured/growth.png"} <= found


def test_a_link_to_nothing_is_refused(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "page.md").write_text("[there](../nothing.md)")
    with pytest.raises(FileNotFoundError, match=r"page.md: the link \.\./nothing\.md"):
        linked_files(tmp_path / "docs", tmp_path)


def test_links_between_docs_and_the_rest() -> None:
    page = "[a](../../experiments/a.md#there) [b](../howto/b.md) ![c](c.png)"
    within = links_within_the_site(page, "validation/page.md", of_docs=True)
    assert within == "[a](../experiments/a.md#there) [b](../howto/b.md) ![c](c.png)"
    back = links_within_the_site("[p](../../docs/validation/proof.md)", "experiments/x/y.md", of_docs=False)
    assert back == "[p](../../validation/proof.md)"


def test_every_option_is_on_the_page() -> None:
    page = command_line.page()
    for name, command in command_line.commands().items():
        section = page.split(f"## greybox {name}\n")[1].split("\n## ")[0]
        for parameter in command.params:
            assert all(option in section for option in parameter.opts if option.startswith("--") and option != "--help")


def test_precision_of_a_design_is_told_from_that_of_numbers() -> None:
    section = command_line.page().split("## greybox design\n")[1].split("\n## ")[0]
    assert "`--precision PARAMETER`" in section and "Not that of numbers, as in fit" in section


def test_every_field_and_setting_is_on_its_page() -> None:
    for page, names in ((card_fields.page(), Card.model_fields), (settings_table.page(), vars(DiagnosisSettings()))):
        assert all(f"| `{name}` |" in page for name in names)


def test_every_public_name_is_on_the_page() -> None:
    page = PAGES["docs/reference/python.md"].read_text(encoding="utf-8")
    assert {line.rsplit(".", 1)[1] for line in page.splitlines() if line.startswith(":::")} == set(gt.__all__)


def test_every_mechanism_is_in_the_gallery() -> None:
    page = gallery.page()
    assert all(f"### {name}\n" in page and LIBRARY[name].source in page for name in BUILT_IN)


@pytest.mark.parametrize("name", sorted(BUILT_IN))
def test_every_law_can_be_seen(name: str) -> None:
    _, over, force = force_over_signal(LIBRARY[name]())
    assert np.isfinite(force).all() and force.shape == over.shape
    assert np.ptp(force) > 1e-3 or name == "constant_bias"


def test_a_dead_zone_looks_like_one() -> None:
    name, over, passed_on = force_over_signal(LIBRARY["actuator_deadzone"]())
    assert name == "input"
    assert np.all(passed_on[np.abs(over) < 0.3] == 0.0) and np.all(np.abs(passed_on[np.abs(over) > 0.6]) > 0.1)
