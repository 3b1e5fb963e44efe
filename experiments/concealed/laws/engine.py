"""What an engine simulates itself: the law is a change to the machine's description there, its switches the names of what is changed."""

from __future__ import annotations

from typing import ClassVar

from experiments.concealed.laws.base import Law


class OfTheEngine(Law):
    """Stands in the catalogue for physics of MuJoCo; never applied by the plants here."""

    places: ClassVar[tuple[str, ...]] = ()
