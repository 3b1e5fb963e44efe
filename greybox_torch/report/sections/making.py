"""How to use the model, and how this page came about."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup

from greybox_torch.diagnosis.beliefs import ANY
from greybox_torch.diagnosis.settings import SettingRow, setting_rows
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text
from greybox_torch.report.about import About


@dataclass(frozen=True)
class Stage:
    """A stage's duration; ``length`` of its bar in % of the longest."""

    name: str
    seconds: str
    length: float


@dataclass(frozen=True)
class Value:
    name: Markup
    owner: str
    value: str
    unit: str


@dataclass(frozen=True)
class Belief:
    """What was known of a hypothesis beforehand; ``port`` and ``mechanism`` are empty where any is meant."""

    mechanism: str
    port: str
    said: str


@dataclass(frozen=True)
class Making:
    facts: tuple[tuple[str, str], ...]
    stages: tuple[Stage, ...]
    values: tuple[Value, ...]
    settings: tuple[SettingRow, ...]
    beliefs: tuple[Belief, ...]
    command: str
    template: str = "making.html.j2"

    @property
    def changed(self) -> tuple[SettingRow, ...]:
        """The settings that differ from their default."""
        return tuple(row for row in self.settings if row.changed)

    @classmethod
    def of(cls, verdict: Verdict, about: About) -> Making:
        facts = (
            ("Data set", verdict.dataset),
            ("Model", verdict.model),
            ("Made", about.created.strftime("%Y-%m-%d %H:%M %Z").strip()),
            ("By", f"greybox_torch {about.version}"),
            ("Seed", str(verdict.seed)),
            ("Device", about.device),
            ("Time", text.seconds(verdict.seconds)),
        )
        longest = max([*verdict.stages.values(), 1e-12])
        stages = [Stage(text.words(n), text.seconds(s), 100.0 * s / longest) for n, s in verdict.stages.items()]
        rows = setting_rows(verdict.settings, verdict.budget)
        beliefs = tuple(_belief(key, p) for key, p in verdict.beliefs.given.items())
        return cls(facts, tuple(stages), tuple(_values(about)), rows, beliefs, about.command)


def _belief(key: str, probability: float) -> Belief:
    port, _, mechanism = key.partition("/")
    said = (
        "excluded"
        if probability == 0.0
        else f"probability {text.number(probability, 2)} where the recordings leave it open"
    )
    return Belief("" if mechanism == ANY else text.mechanism(mechanism), "" if port == ANY else port, said)


def _values(about: About) -> list[Value]:
    units, rows = about.units or {}, []
    for name, value in (about.values or {}).items():
        owner, _, own = name.rpartition(".")
        rows.append(
            Value(
                text.symbol(own),
                ": ".join(map(text.words, owner.split("."))),
                text.number(value, 5),
                text.unit(units.get(name, "")),
            )
        )
    return rows
