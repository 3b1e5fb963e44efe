"""A model with some effects attached, fitted to windows and to whole records, and how two of them compare."""
