from __future__ import annotations

from pathlib import Path

import pytest

from tests.agents.scripted import Server
from tests.patience import STUCK
from wsim.agents import relay
from wsim.agents.ask import Desk
from wsim.agents.budget import Budget, Ledger
from wsim.agents.models import ROLES, Models
from wsim.agents.transcript import Transcript
from wsim.plan.schema import Plan
from wsim.rules.planner import plan as plan_of


@pytest.fixture(autouse=True)
def quick(own_cache: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing waits between two attempts."""
    monkeypatch.setattr(relay, "LONGEST_PAUSE", 0.0)


@pytest.fixture
def desk(server: Server, tmp_path: Path) -> Desk:
    """Asks the server for each role, and writes into a folder `run`."""
    return make_desk(server, tmp_path / "run")


def make_desk(server: Server, folder: Path, **budget: float) -> Desk:
    folder.mkdir(exist_ok=True)
    limits = {"request_seconds": STUCK, **budget}
    models = Models(**{role: server.model(role) for role in ROLES})
    return Desk(models, Transcript(folder), Ledger(Budget(**limits)))  # type: ignore[arg-type]


@pytest.fixture(scope="session")
def slide() -> Plan:
    """A crate on a ramp."""
    return plan_of("A crate slides down a ramp.")
