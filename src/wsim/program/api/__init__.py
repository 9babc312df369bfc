"""The API index: what a program may use, as it is installed.

    from wsim.program.api import index

    index().search("hinge")[0].entry.signature    # "Scene.joint_revolute(name: str, parent: ..."
    index().show("box").parameters

Built from the packages themselves, once for each installation, and cached.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.program.api.entry import Entry, Parameter
    from wsim.program.api.lookup import Index, index
    from wsim.program.api.search import Hit

__all__ = ["Entry", "Hit", "Index", "Parameter", "index"]

__getattr__ = door(
    __name__, {"Entry": "entry", "Parameter": "entry", "Index": "lookup", "index": "lookup", "Hit": "search"}
)
