"""The checkpoints that come with the repository: physics, named and hybrid, of the real arm and of the demo's."""
