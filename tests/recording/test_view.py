from __future__ import annotations

import subprocess
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from tests.patience import STUCK
from wsim.errors import UserError
from wsim.recording import RecordingWriter, read
from wsim.recording.display import has_display
from wsim.recording.view import open_native, rerun_binary, serve_web, view_command

linux_only = pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="reads Linux's table of sockets")


@pytest.fixture
def path(tmp_path, world, make_frame):
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        for i in range(3):
            writer.frame(i / 30, make_frame(i))
        writer.log(0.0, "info", "started")
    return tmp_path / "r.rrd"


def listeners(pid: int) -> set[tuple[str, int]]:
    """(address, port) of every TCP socket that a process listens on; addresses as the kernel prints them."""
    inodes = set()
    for descriptor in Path(f"/proc/{pid}/fd").iterdir():
        target = str(descriptor.readlink())
        if target.startswith("socket:["):
            inodes.add(target[8:-1])
    found = set()
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        if not Path(table).exists():
            continue
        for line in Path(table).read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in inodes:
                address, port = fields[1].split(":")
                found.add((address, int(port, 16)))
    return found


@linux_only
def test_the_web_viewer_listens_on_this_machine_only(path):
    with serve_web(path) as server:
        with urllib.request.urlopen(f"http://127.0.0.1:{server.port}/", timeout=STUCK) as response:
            assert response.status == 200
            assert b"<html>" in response.read()
        assert listeners(server.process.pid) == {("0100007F", server.port), ("0100007F", server.data_port)}
        assert (
            server.url
            == f"http://127.0.0.1:{server.port}/?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A{server.data_port}%2Fproxy"
        )
    assert server.process.poll() is not None
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(f"http://127.0.0.1:{server.port}/", timeout=STUCK)


def test_a_taken_port_is_said(path):
    with serve_web(path) as server, pytest.raises(UserError, match=f"port {server.port} cannot be used"):
        serve_web(path, port=server.port)


def test_a_file_that_rerun_cannot_open_is_said(tmp_path):
    with pytest.raises(UserError, match="no recording at"):
        serve_web(tmp_path / "nothing.rrd")


def test_the_command_opens_the_recording(path):
    command = view_command(path)
    assert command[:2] == [rerun_binary(), str(path)]
    assert command[command.index("--bind") + 1] == "127.0.0.1"
    version = subprocess.run([command[0], "--version"], capture_output=True, text=True, check=True).stdout
    assert "0.41" in version


def test_a_time_and_a_prim_open_a_copy_that_begins_there(path):
    copy = view_command(path, time=0.05, entity="/World/block")[1]
    assert copy != str(path)
    whole, part = read(path), read(copy)
    assert part.time.tolist() == [1 / 30, 2 / 30]
    assert part.world == whole.world
    np.testing.assert_array_equal(part.body_q, whole.body_q[1:])
    np.testing.assert_array_equal(part.fluids["/World/water"].position, whole.fluids["/World/water"].position[1:])
    assert part.log == []  # it came before
    shown = subprocess.run([rerun_binary(), "rrd", "print", "-vvv", copy], capture_output=True, text=True, check=True)
    assert "EyeControls3D:tracking_entity" in shown.stdout
    assert len(RrdReader(copy).blueprints()) == 1
    with pytest.raises(UserError, match=r"no prim '/World/blok'.*/World/block"):
        view_command(path, entity="/World/blok")
    with pytest.raises(UserError, match="no frame at or before -1"):
        view_command(path, time=-1.0)


def test_without_a_display_no_window_is_tried(path, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    assert not has_display()
    with pytest.raises(UserError, match="no display"):
        open_native(path)
    monkeypatch.setenv("DISPLAY", ":0")
    assert has_display()


def test_reruns_own_tools_find_no_fault(path):
    verified = subprocess.run([rerun_binary(), "rrd", "verify", str(path)], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stderr
    stats = subprocess.run([rerun_binary(), "rrd", "stats", str(path)], capture_output=True, text=True)
    assert stats.returncode == 0, stats.stderr
    printed = subprocess.run([rerun_binary(), "rrd", "print", str(path)], capture_output=True, text=True)
    for entity in ("/World/block", "/World/water", "/World/side", "/plots/energy/kinetic", "/log"):
        assert entity in printed.stdout
