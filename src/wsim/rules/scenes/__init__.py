"""The scenes that the builtin planner builds from a cast."""
