"""The root of every error that this project raises on purpose, so that a caller can catch all of them at once."""


class HydrohilError(Exception):
    """Something that was asked for cannot be done; the message is one clear line a problem: what, where, what to do."""
