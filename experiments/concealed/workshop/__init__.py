"""A workshop of machines that the package does not ship: nine machines, their laws and their integrator, in plain Python."""
