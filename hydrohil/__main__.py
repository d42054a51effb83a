"""`python -m hydrohil`: the command line."""

from hydrohil.cli.main import main

main()
