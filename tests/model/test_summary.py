"""What a printed model shows."""

from __future__ import annotations

from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.sensor import SensorBias, SensorGain
from greybox_torch.model import Parameter
from greybox_torch.model.summary import MOST_LINES, summary
from tests.mechanisms.test_layers import layers
from tests.model.test_declarations import Tank


def test_a_printed_model_shows_its_values() -> None:
    """Seen: "(raw): ParameterDict ... [torch.DoubleTensor of size ]", without a value, an effect or a unit."""
    tank = Tank()
    tank.set_values({"area": 4.0})
    assert str(tank).splitlines()[0] == "Tank"
    assert any(line.startswith("  area = 4") for line in repr(tank).splitlines())
    around = Surroundings({"output": Range(0.0, 2.0, 1.0)}, {"output": "m"}, "m", 0.01)
    augmented = layers(around, SensorBias(), SensorGain(), "sensor", 1.0)
    assert repr(augmented).splitlines()[0] == "Tank with sensor_bias at sensor, sensor_gain at sensor"


def test_effects_and_units_are_shown_and_not_hundreds_of_weights() -> None:
    many = [Parameter(f"w_{k}", 1.0, unit="N m", fixed=k == 0) for k in range(MOST_LINES + 2)]
    told = summary("Hoist", ["coulomb_friction at drum"], many, {p.name: 60.0014 for p in many}).splitlines()
    assert told[:3] == ["Hoist with coulomb_friction at drum", "  w_0 = 60.0014 N m (fixed)", "  w_1 = 60.0014 N m"]
    assert told[-1] == "  and 2 more parameters"
