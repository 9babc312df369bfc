"""Run the command line with `python -m wsim.cli`."""

from wsim.cli import main

main()
