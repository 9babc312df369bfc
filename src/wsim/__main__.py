"""`python -m wsim` is `wsim`."""

from wsim.cli import main

main()
