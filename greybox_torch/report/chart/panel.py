"""A panel: marks on two axes, with what the page writes around them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from greybox_torch.report.chart.marks import Mark
from greybox_torch.report.chart.scale import Scale, Tick


@dataclass(frozen=True)
class Live:
    """How a panel is drawn anew over another stretch of time: by series of its marks, the ``names`` of what the chart's samples have.

    The vertical axis follows what is shown within ``clip``; ``detail`` is the stretch that is shaded, in s.
    """

    names: Mapping[str, str]
    clip: tuple[float, float]
    detail: tuple[float, float]
    held: bool = False
    """Whether its lines are steps: every value until the next."""

    @property
    def lines(self) -> str:
        return " ".join(f"{series}:{name}" for series, name in self.names.items())


@dataclass(frozen=True)
class Panel:
    """``alt`` says in a sentence what the picture shows, for those who cannot see it; ``size`` is "tall", "medium" or "low"."""

    x: Scale
    y: Scale
    x_label: str
    y_label: str
    marks: tuple[Mark, ...]
    alt: str
    size: str = "medium"
    title: str = ""
    zero: bool = False
    """Whether the line at zero is drawn."""
    live: Live | None = None

    @property
    def x_ticks(self) -> tuple[Tick, ...]:
        return self.x.ticks(6)

    @property
    def y_ticks(self) -> tuple[Tick, ...]:
        return self.y.ticks(self.most_ticks)

    @property
    def most_ticks(self) -> int:
        """Of the vertical axis, or one more."""
        return {"tall": 6, "medium": 4, "low": 3}[self.size]

    @property
    def zero_line(self) -> float | None:
        """Where zero lies on the vertical axis, if it is to be drawn and within."""
        if not self.zero or not self.y.low < 0 < self.y.high:
            return None
        return -self.y.low / (self.y.high - self.y.low)


@dataclass(frozen=True)
class Key:
    """An entry of a legend: the series, which carries its colour, and its name."""

    series: str
    label: str


@dataclass(frozen=True)
class Chart:
    """Panels with a common legend, as one figure with a caption. ``columns`` (of panels, from top to bottom) stand side by side."""

    columns: tuple[tuple[Panel, ...], ...]
    caption: str
    legend: tuple[Key, ...] = ()
    samples: str = ""
    """What a reader can look closer at, as JSON; empty where a chart stays as it is."""


def stacked(panels: Sequence[Panel], caption: str, legend: Sequence[Key] = ()) -> Chart:
    """Panels one below the other."""
    return Chart((tuple(panels),), caption, tuple(legend))


def side_by_side(panels: Sequence[Panel], caption: str, legend: Sequence[Key] = ()) -> Chart:
    """Panels side by side, as far as the page is wide enough."""
    return Chart(tuple((panel,) for panel in panels), caption, tuple(legend))
