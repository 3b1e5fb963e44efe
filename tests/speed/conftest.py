from __future__ import annotations

from collections.abc import Callable

import pytest

from experiments.speed.settings import missing_peers


@pytest.fixture(scope="session")
def peers() -> Callable[..., None]:
    """Skips a test where a tool of the extra `[peers]` is not installed."""

    def need(*names: str) -> None:
        missing = missing_peers(names)
        if missing:
            pytest.skip(f"{' and '.join(missing)} not installed (extra [peers])")

    return need
