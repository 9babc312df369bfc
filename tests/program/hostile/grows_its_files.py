import ctypes
import mmap
import os
import stat
import struct
import threading

HUGE = 1 << 30


def build(scene):
    libc = ctypes.CDLL(None, use_errno=True)
    libc.fallocate.argtypes = [ctypes.c_int, ctypes.c_int, ctypes.c_long, ctypes.c_long]
    os.open("filler", os.O_RDWR | os.O_CREAT)
    grown = []
    for file in [each for each in range(256) if regular(each)]:
        for way in WAYS:
            try:
                way(libc, file)
            except (OSError, ValueError):
                pass
            grown.append(os.fstat(file).st_blocks * 512)
    print("tried", len(grown), "ways:", max(grown), "bytes")
    os._exit(0)  # what it wrote into its report is not one


def regular(file):
    try:
        return stat.S_ISREG(os.fstat(file).st_mode)
    except OSError:
        return False


def reserve(libc, file):
    for mode in (0, 1, 2 | 1, 8, 16, 16 | 1, 32, 64 | 1):  # keeping the size, and not; holes, zeroes, inserting
        libc.fallocate(file, mode, 0, HUGE)


def reserve_by_ioctl(libc, file):
    space = ctypes.create_string_buffer(struct.pack("hhqqiI4i", 0, 0, 0, HUGE, 0, 0, 0, 0, 0, 0))
    for request in (0x40305828, 0x4030582A, 0x40305839):
        libc.ioctl(file, ctypes.c_ulong(request), space)


def reserve_by_writing(libc, file):
    os.posix_fallocate(file, 0, HUGE)


def clone(libc, file):
    other = os.open("other", os.O_RDWR | os.O_CREAT)
    libc.ioctl(file, ctypes.c_ulong(0x40049409), ctypes.c_int(other))
    os.close(other)


def stretch_and_map(libc, file):
    os.ftruncate(file, 1 << 40)


def map_past_the_end(libc, file):
    os.ftruncate(file, 4096)
    with mmap.mmap(file, 4096) as view:
        try:
            view.resize(HUGE)
        except (OSError, ValueError, SystemError):
            pass
    os.ftruncate(file, 0)


def write(libc, file):
    block = bytes(1 << 20)
    for offset in (0, HUGE, 1 << 40):
        for i in range(64):
            try:
                os.pwrite(file, block, offset + (i << 20))
            except OSError:
                break


def write_at_the_end(libc, file):
    end = os.open(f"/proc/self/fd/{file}", os.O_WRONLY | os.O_APPEND)
    for _ in range(64):
        os.write(end, bytes(1 << 20))


def copy(libc, file):
    source = os.open("source", os.O_RDWR | os.O_CREAT)
    os.pwrite(source, bytes(1 << 20), 0)
    for i in range(64):
        try:
            os.copy_file_range(source, file, 1 << 20, 0, (i << 20))
        except OSError:
            break
    os.copy_file_range(source, file, 1 << 20, 0, HUGE)


def send(libc, file):
    source = os.open("source", os.O_RDWR | os.O_CREAT)
    os.pwrite(source, bytes(1 << 20), 0)
    os.lseek(file, 0, os.SEEK_SET)
    for _ in range(64):
        os.sendfile(file, source, 0, 1 << 20)


def splice(libc, file):
    end, start = os.pipe()
    for i in range(1024):
        os.write(start, bytes(1 << 16))
        os.splice(end, file, 1 << 16, None, i << 16)


def write_later(libc, file):
    context = ctypes.c_ulong(0)
    libc.syscall(206, 64, ctypes.byref(context))
    block = ctypes.create_string_buffer(1 << 20)
    request = struct.pack("QIIHhIQQqQII", 0, 0, 0, 1, 0, file, ctypes.addressof(block), 1 << 20, HUGE, 0, 0, 0)
    head = ctypes.create_string_buffer(request)
    pointers = (ctypes.c_void_p * 1)(ctypes.addressof(head))
    libc.syscall(209, context, 1, pointers)


def write_from_many_threads(libc, file):
    threads = [threading.Thread(target=write, args=(libc, file)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


WAYS = (
    stretch_and_map,
    map_past_the_end,
    clone,
    write,
    write_at_the_end,
    copy,
    send,
    splice,
    write_later,
    write_from_many_threads,
    reserve_by_writing,
    reserve_by_ioctl,
    reserve,  # last: what it takes stays taken
)
