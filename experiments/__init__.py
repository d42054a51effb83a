"""Experiments as data: what the machine is, what it is asked to do, and what must be seen."""
