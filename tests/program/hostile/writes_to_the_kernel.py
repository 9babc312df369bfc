import os

MOST = 200_000  # entries looked at


def build(scene):
    opened, seen, folders = [], 0, ["/proc", "/sys", "/dev"]
    while folders and seen < MOST:
        folder = folders.pop()
        try:
            entries = list(os.scandir(folder))
        except OSError:
            entries = []
        for entry in entries:
            seen += 1
            if entry.is_dir(follow_symlinks=False):
                folders.append(entry.path)
                continue
            try:
                os.close(os.open(entry.path, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY))
            except OSError:
                continue
            opened.append(entry.path)
    parent = f"/proc/{os.getppid()}"
    for path in [*KNOWN, f"{parent}/mem", f"{parent}/comm", *(f"{parent}/fd/{i}" for i in range(32))]:
        try:
            os.close(os.open(path, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY))
        except OSError:
            continue
        opened.append(path)
    opened = [path for path in opened if path not in ALLOWED]
    raise AssertionError(f"{len(opened)} opened {opened[:5]}")


# A folder that cannot be listed may hold files that can be opened: Landlock hides names, not paths.
KNOWN = [
    "/proc/sys/kernel/core_pattern",
    "/proc/sys/kernel/hostname",
    "/proc/sys/kernel/modprobe",
    "/proc/sys/kernel/ns_last_pid",
    "/proc/sys/net/ipv4/ip_forward",
    "/proc/sys/vm/drop_caches",
    "/proc/sys/vm/overcommit_memory",
    "/proc/sysrq-trigger",
    "/proc/self/mem",
    "/proc/thread-self/mem",
    "/proc/self/oom_score_adj",
    "/proc/self/clear_refs",
    "/proc/self/timerslack_ns",
    "/proc/self/comm",
    "/proc/self/uid_map",
    "/proc/1/mem",
    "/proc/1/root/dev/null",
    "/sys/kernel/mm/transparent_hugepage/enabled",
    "/sys/fs/cgroup/cgroup.procs",
    "/sys/module/kernel/parameters/panic",
    "/dev/shm/planted",
    "/dev/ptmx",
    "/dev/tty",
    "/dev/mem",
    "/dev/kmsg",
    "/dev/fuse",
    "/dev/kvm",
]
# What any program may write to, and nothing comes of it: the sink, and the kernel's pool of chance.
ALLOWED = ["/dev/null", "/dev/zero", "/dev/random", "/dev/urandom"]
