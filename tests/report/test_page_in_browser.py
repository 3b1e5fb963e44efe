"""The page in a browser, 390 px wide as on a phone: nothing is cut off, and nothing is complained of on the console."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.curve import FreeCurve
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.own_parameters import Estimate
from greybox_torch.diagnosis.traces import InputTrace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page
from tests.browser import after_scripts, needs_browser

LOOK = """<!doctype html><meta charset="utf-8"><body>{frames}<script>
onload = () => {{
  const told = [...document.querySelectorAll("iframe")].map((frame) => {{
    const page = frame.contentDocument, width = frame.contentWindow.innerWidth;
    page.querySelectorAll("details").forEach((one) => (one.open = true));
    const scrolls = (e) => e.closest("svg, pre, details, script");
    const wide = [...page.querySelectorAll("body *")].filter((e) => e.getBoundingClientRect().right > width + 0.5 && !scrolls(e));
    const buttons = page.querySelectorAll(".zoom button").length;
    return [frame.name, page.documentElement.scrollWidth <= width, buttons, ...wide.map((e) => e.outerHTML.slice(0, 60))].join(",");
  }});
  document.title = told.join(" / ");
}};
</script>"""


def full(verdict: Verdict) -> Verdict:
    """With all that a page can have: inputs, a class, the law over data, a stopped search, beliefs."""
    inputs = tuple(InputTrace(t.experiment, "torque", "N m", t.time, np.sin(9.0 * t.time)) for t in verdict.traces)
    effects = []
    for effect in verdict.effects:
        assert effect.curve is not None
        force, at = effect.curve.force, effect.curve.values[::5]
        free = FreeCurve(force, 0.01 + 0.0 * force, at, force[::5], 62)
        members = (Alternative(effect.port, effect.mechanism, 0.5), Alternative("actuator", "input_lag", 0.4))
        one_of = OneOf("about 1.1 ms pass between motor_torque_of_the_drive and measured motor_speed", 0.9, members)
        effects.append(replace(effect, curve=replace(effect.curve, free=free), one_of=one_of))
    beliefs = Beliefs({"gear_spring/position_dependent_friction": 0.3})
    many = (123.456789, 0.000123)
    own = Estimate("friction_coefficient", "N m s/rad", 0.00123, many, many if verdict.effects else None)
    return replace(verdict, parameters=(own,), inputs=inputs, effects=tuple(effects), complete=False, beliefs=beliefs)


@needs_browser
def test_on_a_phone(of_kind: Callable[[str], Verdict], about: About, tmp_path: Path) -> None:
    kinds = ("found", "unknown", "memory", "nothing")
    for kind in kinds:
        (tmp_path / f"{kind}.html").write_text(render_page(full(of_kind(kind)), about), encoding="utf-8")
    frames = "".join(
        f'<iframe name="{k}" src="{k}.html" style="border: 0; width: 390px; height: 700px"></iframe>' for k in kinds
    )
    page = tmp_path / "look.html"
    page.write_text(LOOK.format(frames=frames), encoding="utf-8")
    title, _ = after_scripts(page, tmp_path, "--allow-file-access-from-files")
    assert title.split(" / ") == [f"{kind},true,5" for kind in kinds]
