"""Exit statuses of every command and service."""

EXIT_OK, EXIT_CLAIM, EXIT_USAGE, EXIT_TRIPPED, EXIT_TRANSPORT = 0, 1, 2, 3, 5
EXIT_BUG = 70  # an unexpected error: a fault of hydrohil itself (sysexits.h: EX_SOFTWARE)
EXIT_INTERRUPTED = 130
