"""The router: one process that forwards between sessions that do not reach each other directly."""
