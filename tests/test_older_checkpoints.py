"""Models that an earlier version saved, with laws that have gained a parameter since."""

from __future__ import annotations

from pathlib import Path

from greybox_torch import load
from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.mechanisms.stored import stored_effects
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.systems import RobotArm


def test_what_a_law_did_not_have_when_a_model_was_saved_is_zero(tmp_path: Path) -> None:
    """Play as an earlier version saved it, whose damper goes on within the gap."""
    arm = RobotArm()
    around = {p.name: Surroundings({}, {}, "N m", 1e-3) for p in arm.all_ports}
    signals = {"deflection": Range(-0.1, 0.1, 0.05), "rate": Range(-1.0, 1.0, 0.5)}
    around["gear_spring"] = Surroundings(signals, {}, "N m", 1e-3)
    model = AugmentedModel(arm, [attach(arm, "gear_spring", Backlash(), "+gear_twist")], around)
    values = {p.name: p.value for p in model.declared_parameters} | {"gear_spring.backlash.half_gap": 0.01}
    later = "gear_spring.backlash.damping"
    held = {name: value for name, value in values.items() if name != later}
    units = {p.name: p.unit for p in model.declared_parameters if p.name != later}
    checkpoint = Checkpoint("robot_arm", arm.title, held, units, effects=stored_effects(model))
    save_checkpoint(tmp_path / "old", checkpoint)
    found = load(tmp_path / "old").values()
    assert found[later] == 0.0 and found["gear_spring.backlash.half_gap"] == 0.01
    assert list(found) == list(values)


def test_a_network_that_reads_another_port_keeps_its_weights(tmp_path: Path) -> None:
    """As an earlier version saved it, with the sign of the signal's name in those of its parameters."""
    arm, signal = RobotArm(), "load@arm"
    around = {p.name: Surroundings({}, {}, "N m", 1e-3) for p in arm.all_ports}
    ranges = {"speed": Range(-5.0, 5.0, 2.0), signal: Range(-1.0, 1.0, 0.5)}
    around["motor"] = Surroundings(ranges, {}, "N m", 1e-3)
    model = AugmentedModel(arm, [attach(arm, "motor", ResidualNet(("speed", signal), 2), "+motor_speed")], around)
    values = {p.name: p.value for p in model.declared_parameters} | {"motor.residual_net.load_arm_1": 0.375}
    old = {name: name.replace("load_arm_", f"{signal}_") for name in values}
    units = {old[p.name]: p.unit for p in model.declared_parameters}
    held = {old[name]: value for name, value in values.items()}
    assert f"motor.residual_net.{signal}_1" in held
    save_checkpoint(tmp_path / "old", Checkpoint("robot_arm", arm.title, held, units, effects=stored_effects(model)))
    assert load(tmp_path / "old").values() == values
