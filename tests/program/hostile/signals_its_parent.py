import ctypes
import os
import signal


def build(scene):
    import resource

    hit = []
    for pid in {os.getppid(), int(scene.param("victim", 1.0)), -1, 0}:
        try:
            os.kill(pid, signal.SIGKILL)
            hit.append(pid)
        except OSError:
            pass
    try:
        resource.prlimit(int(scene.param("again", 1.0)) or os.getppid(), resource.RLIMIT_CPU, (1, 1))
        hit.append("prlimit")
    except OSError:
        pass
    if ctypes.CDLL(None).prctl(1, 0, 0, 0, 0) == 0:
        hit.append("prctl")
    raise AssertionError(f"HIT {hit}" if hit else "nobody was hurt")
