"""Which model each role has: options, then the environment, then the configuration file, then none."""

from __future__ import annotations

import os
import re
import tomllib
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.errors import UserError

if TYPE_CHECKING:
    from pydantic_ai.models import Model

BUILTIN = "builtin"
ROLES = ("planner", "coder", "reviewer", "judge")
CONFIG = "wsim.toml"
_HELP = (
    'give "builtin", a provider and a model such as "openai:MODEL", or a model of an OpenAI-compatible server as '
    '"MODEL@http://127.0.0.1:8000/v1"'
)


@dataclass(frozen=True)
class Models:
    """The name of each role's model; "builtin" uses no model."""

    planner: str = BUILTIN
    coder: str = BUILTIN
    reviewer: str = BUILTIN
    judge: str = BUILTIN

    def __getitem__(self, role: str) -> str:
        return str(getattr(self, role))

    @property
    def any(self) -> bool:
        """Whether a role has one."""
        return any(self[role] != BUILTIN for role in ROLES)

    def facts(self) -> dict[str, str]:
        """For run.json."""
        return {role: self[role] for role in ROLES}


def choose(default: str | None = None, **by_role: str | None) -> Models:
    """The models that were asked for.

    Args:
        default: For every role that is not named: `--model`.
        by_role: By role: `--planner-model` and so on.

    Raises:
        UserError: If the configuration file is not one, or a name is no model's.
    """
    models = Models()
    for given in (_configured(Path(CONFIG)), _environment(), {"model": default, **by_role}):
        if given.get("model"):
            models = Models(*[str(given["model"])] * len(ROLES))
        models = replace(models, **{role: str(given[role]) for role in ROLES if given.get(role)})
    for field in fields(models):
        _check(getattr(models, field.name), field.name)
    return models


def _environment() -> dict[str, Any]:
    named = {role: os.environ.get(f"WSIM_{role.upper()}_MODEL") for role in ROLES}
    return {"model": os.environ.get("WSIM_MODEL"), **named}


def _configured(path: Path) -> dict[str, Any]:
    """[models] of wsim.toml in the folder where wsim is run: model, planner, coder, reviewer, judge."""
    if not path.is_file():
        return {}
    try:
        whole = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{path}: {error}") from error
    found = whole.pop("models", {})
    if whole or not isinstance(found, dict):
        raise UserError(f"{path}: it has one table, [models]; not {next(iter(whole), 'models = ...')!r}")
    unknown = [key for key in found if key not in ("model", *ROLES)]
    if unknown:
        raise UserError(f"{path}: [models] knows model, {', '.join(ROLES)}; not {unknown[0]!r}")
    return found


def _check(name: str, role: str) -> None:
    if name == BUILTIN:
        return
    model, url = _parted(name)
    if not model.strip(":") or (not url and ":" not in model):
        raise UserError(f"model of the {role}: {name!r} is none; {_HELP}")


def _parted(name: str) -> tuple[str, str]:
    """A model and the URL of its server, empty if it has none; the name of a model may have an @ of its own."""
    model, url = re.fullmatch(r"(.*?)(?:@(https?://.*))?", name, re.DOTALL).groups(default="")  # type: ignore[union-attr]
    return model, url


def reach(models: Models) -> None:
    """Look whether every model can be reached by its name, before a run's folder is made; nothing is asked.

    Raises:
        UserError: If one cannot: no such provider, or it lacks its key.
    """
    for role in ROLES:
        if models[role] != BUILTIN:
            connect(models[role], role)


def connect(name: str, role: str) -> Model:
    """A model by its name: `provider:model` of pydantic-ai, or `model@base-url` of an OpenAI-compatible server.

    Raises:
        UserError: If there is no such provider, or it lacks its key.
    """
    from pydantic_ai.exceptions import UserError as ModelUserError  # a second to load: builtin roles need none
    from pydantic_ai.models import infer_model

    model, url = _parted(name)
    base = os.environ.get("OPENAI_BASE_URL")
    if not url and base and model.startswith("openai:"):
        model, url = model.removeprefix("openai:"), base
    try:
        if url:
            from pydantic_ai.models.openai import OpenAIChatModel  # a second to load: builtin roles need none
            from pydantic_ai.providers.openai import OpenAIProvider

            key = os.environ.get("OPENAI_API_KEY") or "none"
            return OpenAIChatModel(model, provider=OpenAIProvider(base_url=url, api_key=key))
        return infer_model(name)
    except (ModelUserError, ImportError, ValueError) as error:
        first = str(error).strip().splitlines()[0].split(". ")[0]
        raise UserError(f"model of the {role}: {name}: {first}; {_HELP}") from error
