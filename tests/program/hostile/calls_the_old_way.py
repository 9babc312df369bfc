import ctypes
import mmap


def build(scene):
    """A 32-bit program's socketpair, by its own door into the kernel; its numbers mean other calls in the filter."""
    # mov eax, 360; mov ebx, 1; mov ecx, 2; xor edx, edx; mov esi, 0; int 0x80; ret
    code = bytes.fromhex("53 b868010000 bb01000000 b902000000 31d2 be00000000 cd80 5b c3")
    page = mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
    page.write(code)
    call = ctypes.CFUNCTYPE(ctypes.c_long)(ctypes.addressof(ctypes.c_char.from_buffer(page)))
    raise AssertionError(f"RETURNED {call()}")
