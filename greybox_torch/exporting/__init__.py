"""A model taken home: as C, as a module of torch, as an FMU. What is written needs nothing of this package."""
