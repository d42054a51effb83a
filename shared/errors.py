"""The root of every error that this project raises on purpose, so that a caller can catch all of them at once."""

from hydrohil.shared.exit_status import EXIT_USAGE


class HydrohilError(Exception):
    """Something that was asked for cannot be done; the message is one clear line a problem: what, where, what to do."""

    exit_status = EXIT_USAGE  # of a command that ends with it


class FileError(HydrohilError, ValueError):
    """A file is not what it should be: a trace, a recording, a trip report; the message names the file."""


class MissingPackageError(HydrohilError, ImportError):
    """A package that only this request needs is not installed; the message says how to install it."""


class UnknownNameError(HydrohilError, LookupError):
    """A name that means nothing here; the message names the nearest."""


class AddressError(HydrohilError, ValueError):
    """Where services run cannot be read: hosts or a router; the message shows how to write it."""
