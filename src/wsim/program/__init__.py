"""The program: composed from a plan, and run where it can do no harm."""
