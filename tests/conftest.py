from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, Protocol

import numpy as np
import pytest
from hypothesis import settings

from greybox_torch.data import Channel, DataSet, InitialEntry, ParameterEntry, Recording, Role
from tests.pictures import unpainted as unpainted
from tests.sled import sled_run as sled_run

RunFile = Callable[..., ModuleType]

LONGEST = ("test_notebook.py", "test_demo.py", "test_train.py", "test_interruption.py")
"""Files with tests of ten seconds and more: begun last, they would leave a core idle at the end."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest first."""
    items.sort(key=lambda item: item.path.name not in LONGEST)


settings.register_profile("greybox", deadline=None, max_examples=30)
settings.load_profile("greybox")

CARD = """\
name = "Bench motor"
sample_time = 0.01
hold = "zoh"

[channels]
voltage = { column = "u", unit = "V" }
speed = { column = "y", unit = "rad/s", scale = 2.0 }

[[experiment]]
name = "Steps"
file = "steps.csv"
role = "estimation"

[[experiment]]
name = "Sweep"
file = "sweep.npz"
role = "validation"
columns = { voltage = "u_val" }

[model.parameters]
J = { value = 0.5, lower = 0.0, upper = 1.0 }
"""


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """A folder `bench` with a sound data set: 40 samples of CSV with time stamps and one gap, 20 samples of npz."""
    folder = tmp_path / "bench"
    folder.mkdir()
    (folder / "dataset.toml").write_text(CARD)
    lines = [f"{0.01 * k:.2f},{k % 5},{'' if k == 7 else k / 4}" for k in range(40)]
    (folder / "steps.csv").write_text("\n".join(["t,u,y", *lines]) + "\n")
    np.savez(folder / "sweep.npz", u_val=np.arange(20.0), y=np.linspace(-1, 1, 20), t=np.arange(20) * 0.02)
    return folder


@pytest.fixture(scope="session")
def machines() -> Path:
    """The folder of model files that tests load as a user would."""
    return Path(__file__).parent / "machines"


class MakeDataSet(Protocol):
    def __call__(
        self,
        units: dict[str, str],
        experiments: list[dict[str, np.ndarray]],
        *,
        sample_time: float = 0.01,
        hold: Literal["zoh", "foh"] = "zoh",
        roles: list[Role] | None = None,
        parameters: dict[str, dict[str, Any]] | None = None,
        initial: dict[str, dict[str, Any]] | None = None,
    ) -> DataSet: ...


@pytest.fixture(scope="session")
def data_set() -> MakeDataSet:
    """Makes a data set of arrays: units by channel, then for each experiment its signals by channel (and perhaps "time")."""

    def make(units, experiments, *, sample_time=0.01, hold="zoh", roles=None, parameters=None, initial=None):
        recordings = []
        for e, signals in enumerate(experiments):
            length = len(next(iter(signals.values())))
            time = np.asarray(signals.get("time", np.arange(length) * sample_time))
            own = {name: np.asarray(signals[name], dtype=float) for name in units}
            role = "estimation" if roles is None else roles[e]
            step = float(np.median(np.diff(time)))
            recordings.append(Recording(f"run {e + 1}", role, time, step, own, Path("memory"), (0, length)))
        return DataSet(
            name="made",
            path=Path("dataset.toml"),
            hold=hold,
            channels={name: Channel(name, unit) for name, unit in units.items()},
            recordings=tuple(recordings),
            model=None,
            parameters={name: ParameterEntry(**entry) for name, entry in (parameters or {}).items()},
            initial={name: InitialEntry(**entry) for name, entry in (initial or {}).items()},
            held_out_by_default=False,
        )

    return make


class MotorSpeed(Protocol):
    def __call__(
        self,
        voltage: np.ndarray,
        *,
        inertia: float = 0.02,
        gain: float = 0.1,
        damping: float = 0.05,
        start: float = 0.0,
    ) -> np.ndarray: ...


@pytest.fixture(scope="session")
def motor_speed() -> MotorSpeed:
    """The exact speed of the documentation's motor at samples 10 ms apart, its voltage constant between them."""

    def simulate(voltage, *, inertia=0.02, gain=0.1, damping=0.05, start=0.0):
        decay = np.exp(-damping / inertia * 0.01)
        speeds = [start]
        for v in voltage[:-1]:
            speeds.append(decay * speeds[-1] + (1 - decay) * gain / damping * v)
        return np.array(speeds)

    return simulate


MOTOR_CARD = """\
name = "Motor on the bench"
sample_time = 0.01
hold = "zoh"

[channels]
voltage = { column = "v", unit = "V" }
speed = { column = "w", unit = "rad/s" }

[[experiment]]
name = "Steps"
file = "steps.csv"
role = "estimation"

[[experiment]]
name = "More steps"
file = "more.csv"
role = "estimation"

[[experiment]]
name = "Sweep"
file = "sweep.csv"
role = "validation"

[model]
name = "my_motor.py:Motor"

[model.parameters]
J = { value = 0.03 }
b = { value = 0.08, upper = 1.0 }
"""


@pytest.fixture
def motor_folder(tmp_path: Path, machines: Path, motor_speed: MotorSpeed) -> Callable[..., Path]:
    """Makes a folder with the documentation's motor and recordings of it: a card, a model file, three experiments.

    The true J is 0.02 and b 0.05. Voltages below ``dead_zone`` do nothing to the true motor, which the model does not know.
    """

    def make(dead_zone: float = 0.0, noise: float = 0.02) -> Path:
        folder = tmp_path / "motor"
        folder.mkdir()
        (folder / "my_motor.py").write_text((machines / "motor.py").read_text())
        (folder / "dataset.toml").write_text(MOTOR_CARD)
        rng, time = np.random.default_rng(0), np.arange(600) * 0.01
        sweep = 2.5 * np.sin(2 * np.pi * 0.3 * time * (1 + 0.3 * time))
        voltages = {
            "steps": np.repeat(rng.uniform(-3, 3, 30), 20),
            "more": np.repeat(rng.uniform(-3, 3, 16), 25),
            "sweep": np.floor(sweep * 20) / 20,
        }
        for name, voltage in voltages.items():
            acting = np.sign(voltage) * np.maximum(np.abs(voltage) - dead_zone, 0.0)
            speed = motor_speed(acting, start=0.3) + rng.normal(0, noise, len(voltage))
            rows = np.column_stack([voltage, speed])
            np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header="v,w", comments="", fmt="%.12g")
        return folder

    return make


@pytest.fixture
def edit() -> Callable[[Path, str, str], None]:
    """Replaces text in a file, where it stands exactly once."""

    def replace_once(path: Path, old: str, new: str) -> None:
        text = path.read_text()
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {path}"
        path.write_text(text.replace(old, new))

    return replace_once


@pytest.fixture
def run_file(tmp_path: Path) -> Iterator[RunFile]:
    """Writes a user's file and runs it; what it registers is taken out again after the test."""
    from greybox_torch.data.readers import READERS
    from greybox_torch.mechanisms.library import LIBRARY
    from greybox_torch.report.sections.order import SECTIONS, TEMPLATES

    tables: tuple[dict, ...] = (LIBRARY, READERS, SECTIONS, TEMPLATES)
    before = [dict(table) for table in tables]

    def run(name: str, text: str) -> ModuleType:
        file = tmp_path / name
        file.write_text(text)
        spec = importlib.util.spec_from_file_location(f"user_{file.stem}", file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
        return module

    yield run
    for table, was in zip(tables, before, strict=True):
        table.clear()
        table.update(was)
