"""What effects are in the words of simulators of jointed bodies: attributes of joints, tendons and actuators (MJCF, URDF)."""
