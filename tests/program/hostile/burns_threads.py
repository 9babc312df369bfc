import ctypes
import threading


def build(scene):
    # A signal handler and threads must not keep it alive.
    import signal

    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGXCPU):
        signal.signal(number, signal.SIG_IGN)
    for _ in range(4):
        threading.Thread(target=lambda: ctypes.CDLL(None).pause()).start()
    while True:
        pass
