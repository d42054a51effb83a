"""The command line: start cells, run experiments, stop them."""
