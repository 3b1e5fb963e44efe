"""Pictures that a test looks at by name alone are not painted: matplotlib takes up to half a second for each."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ONE_PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=="
)


@contextmanager
def not_painted() -> Iterator[None]:
    """Figures are put together as ever; in the place of the file of each there is one of a pixel."""

    def pixel(figure: Figure, dots_per_inch: float | None = None) -> bytes:
        assert figure.axes, "there is something to paint"
        return ONE_PIXEL

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("greybox_torch.report.notebook.png", pixel)
        yield


@pytest.fixture
def unpainted() -> Iterator[None]:
    """For tests of commands on recordings that others paint: what is unusual to draw is painted."""
    with not_painted():
        yield
