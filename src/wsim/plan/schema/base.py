"""What every part of a plan is made of: strict models, and numbers and names with bounds."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer

MOST = 1e6  # no length, speed or time in a plan is larger: beyond it a 32-bit simulation has no millimetres left
Number = Annotated[float, Field(ge=-MOST, le=MOST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, le=MOST, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, le=MOST, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]
Vec3 = tuple[Number, Number, Number]
Color = tuple[Share, Share, Share]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=80)]
Text = Annotated[str, Field(max_length=4000)]
Word = Annotated[str, Field(min_length=1, max_length=200)]


class Strict(BaseModel):
    """A model that takes no field that it does not know, and no number that is not finite."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Sparse(Strict):
    """A model whose open fields are not written, so that a plan without them reads as it always did."""

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {name: value for name, value in write(self).items() if value is not None}
