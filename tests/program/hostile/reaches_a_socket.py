import array
import ctypes
import os
import platform
import socket
import struct


def build(scene):
    target = __file__.replace("reaches_a_socket.py", "socket")
    reached = [way.__name__ for way in (by_python, by_bare_calls, by_a_name_without_a_file) if tried(way, target)]
    raise AssertionError(f"REACHED {reached}" if reached else "nobody was reached")


def tried(way, target):
    try:
        return way(target)
    except OSError:
        return False


def by_python(target):
    one, _ = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    one.sendto(b"python", target)
    return True


def by_bare_calls(target):
    libc = ctypes.CDLL(None, use_errno=True)
    x86 = platform.machine() == "x86_64"
    address = struct.pack("H", 1) + target.encode() + b"\0"
    pair = (ctypes.c_int * 2)(-1, -1)
    made = []
    for kind in (1, 2, 5):  # a stream, datagrams, packets
        made.append(libc.syscall(53 if x86 else 199, 1, kind, 0, pair))
        made.append(libc.syscall(41 if x86 else 198, 1, kind, 0))
    # Whatever is open: the address may be all that a call wants of it.
    text = ctypes.create_string_buffer(b"bare")
    part = array.array("Q", [ctypes.addressof(text), 4])
    head = ctypes.create_string_buffer(address)
    message = array.array("Q", [ctypes.addressof(head), len(address), part.buffer_info()[0], 1, 0, 0, 0, 0])
    for descriptor in range(256):
        made.append(libc.syscall(44 if x86 else 206, descriptor, text, 4, 0, head, len(address)))
        made.append(libc.syscall(46 if x86 else 211, descriptor, ctypes.c_void_p(message.buffer_info()[0]), 0))
        made.append(libc.syscall(307 if x86 else 269, descriptor, ctypes.c_void_p(message.buffer_info()[0]), 1, 0))
        made.append(libc.syscall(42 if x86 else 203, descriptor, head, len(address)))
        made.append(libc.syscall(49 if x86 else 200, descriptor, head, len(address)))
    made.append(libc.syscall(425, 4, ctypes.create_string_buffer(256)))  # io_uring has sockets of its own
    made.append(libc.syscall(0x40000000 + 53, 1, 2, 0, pair))  # x32's socketpair
    return any(value >= 0 for value in made)


def by_a_name_without_a_file(target):
    one, _ = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    one.sendto(b"abstract", "\0" + os.path.basename(os.path.dirname(target)))
    return True
