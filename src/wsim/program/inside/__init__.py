"""What runs inside the sandbox, beside the generated program. Standard library only, until the program needs more."""
