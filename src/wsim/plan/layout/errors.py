"""What a plan's author has to mend."""

from wsim.errors import UserError


class LayoutError(UserError):
    """The plan's relations cannot be laid out: one line that names the rows, the values and the way out."""
