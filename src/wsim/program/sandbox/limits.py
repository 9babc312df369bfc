"""What a program may use."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

_MIB = 1 << 20


class Limits(BaseModel):
    """Limits of one sandboxed process. The defaults fit a program that authors some thousand prims."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)

    wall_seconds: float = Field(30.0, gt=0.0, le=3600.0)  # [s]
    cpu_seconds: float | None = Field(60.0, ge=1.0)  # [s], over all threads; None: not limited
    memory_bytes: int = Field(4096 * _MIB, ge=2048 * _MIB)  # address space [B]; Python and USD alone take 1300 MiB
    scratch_bytes: int = Field(256 * _MIB, ge=_MIB)  # all files of the scratch folder together [B]
    file_bytes: int = Field(128 * _MIB, ge=_MIB)  # any one file, the stage too [B]
    log_bytes: int = Field(_MIB, ge=1024)  # what it may print [B]
    open_files: int = Field(256, ge=32)
    threads: int = Field(256, ge=4)
    check_seconds: float = Field(30.0, gt=0.0, le=3600.0)  # [s], for the check of the stage
    call_seconds: float = Field(2.0, gt=0.0, le=600.0)  # [s], for one call of `control`
    first_call_seconds: float = Field(20.0, gt=0.0, le=600.0)  # [s], for starting it and for its first call
