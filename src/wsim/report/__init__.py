"""The report of a run: one HTML file that opens offline."""

from __future__ import annotations

from pathlib import Path

__all__ = ["write"]


def write(run_dir: str | Path) -> Path:
    """Write `report.html` in the folder of a run, from what the run left there.

    A run that failed early has no recording, video or plan: the report shows what there is.

    Args:
        run_dir: The run's folder.

    Returns:
        The report's path.

    Raises:
        UserError: There is no such folder.
    """
    from wsim.report.page import write_page

    return write_page(Path(run_dir))
