"""Code for the compiled stepper: a model's equations traced once, differentiated symbolically, written as C++ and compiled."""
