"""Ends all that a test started, daemons and their orphans included."""

import ctypes
import os
import signal
import time

PR_SET_CHILD_SUBREAPER = 36


def adopt_orphans():
    """From now on a descendant whose parent ends becomes a child of this process, not of init."""
    if ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl(PR_SET_CHILD_SUBREAPER) failed; it needs Linux 3.4")


def descendants():
    parents = {}
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                # The name of the program, in parentheses, may hold anything.
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except OSError:
            continue  # it ended
        if state != "Z":
            parents[int(name)] = int(parent)
    found = [os.getpid()]
    for process in found:
        found += [child for child, parent in parents.items() if parent == process]
    return found[1:]


def end_descendants(patience=5.0):
    """Asks all to end, and kills those that don't within `patience` seconds, until none is left."""
    begin = time.monotonic()
    while processes := descendants():
        sent = signal.SIGTERM if time.monotonic() - begin < patience else signal.SIGKILL
        for process in processes:
            try:
                os.kill(process, sent)
            except ProcessLookupError:
                pass
        time.sleep(0.2)
    try:
        while os.waitpid(-1, os.WNOHANG)[0] > 0:
            pass
    except ChildProcessError:
        pass
