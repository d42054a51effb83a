"""The router: one process that forwards between sessions which do not reach each other directly."""
