"""What physics, named mechanisms, a network beside them, and a network alone each bring: the same data, the same scores."""
