"""Recordings of real machines in which physics that is known to be there is concealed from the model."""
