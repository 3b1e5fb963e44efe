"""The page of the mechanisms: law, picture, source, and what shows each of them, from the library."""

from __future__ import annotations

from documentation.law_picture import picture
from greybox_torch.mechanisms.library import BUILT_IN, LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism

PORTS = {
    "body": "At a body",
    "coupling": "At a coupling",
    "balance": "At a balance",
    "actuator": "At an actuator",
    "sensor": "At a sensor",
}


def page() -> str:
    """The page in Markdown."""
    lines = [
        "# Mechanisms",
        "",
        "Every law that `greybox diagnose` knows, by the port where it may act. The pictures show its force over a signal that "
        "swings; at an actuator or a sensor, and where a law changes a deflection, they show the changed signal beside what it would be "
        "(dashed). A loop means that the law has a memory. A law of your own joins them by [a class in your file](../howto/extending.md).",
    ]
    for kind, title in PORTS.items():
        lines += ["", f"## {title}"]
        for name in LIBRARY:
            mechanism = LIBRARY[name]
            if name in BUILT_IN and mechanism.kinds[0] == kind:
                lines += _entry(mechanism)
    return "\n".join(lines) + "\n"


def _entry(mechanism: type[Mechanism]) -> list[str]:
    also = [PORTS[kind].removeprefix("At a").removeprefix("n").strip() for kind in mechanism.kinds[1:]]
    lines = [
        "",
        f"### {mechanism.name}",
        "",
        f"![{mechanism.name}](mechanisms/{mechanism.name}.svg){{ align=right }}",
        "",
        mechanism.explanation,
        "",
        f"Law: {mechanism.described()}.",
        "",
    ]
    if mechanism.experiment:
        lines += [f"What shows it: {mechanism.experiment}.", ""]
    if also:
        lines += [f"Also at: {', '.join(also)}.", ""]
    return [*lines, f"Source: {mechanism.source}."]


def pictures() -> dict[str, bytes]:
    """The pictures of the page, by their place beside it."""
    return {f"mechanisms/{name}.svg": picture(LIBRARY[name]()) for name in LIBRARY if name in BUILT_IN}
