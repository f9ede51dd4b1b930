"""Copies what `cargo test` says, and writes how long each test program took.

    cargo test 2>&1 | timed.py SECONDS.txt

A program begins with cargo's line "Running …" or "Doc-tests …" and ends with the next one.
"""

import re
import sys
import time

BEGINS = re.compile(r"^\s+(?:Running (?P<path>\S+ ?\S*) \((?P<file>[^)]*)\)|Doc-tests (?P<doc>\S+))")


def main(into):
    sys.stdin.reconfigure(errors="replace")
    seconds, name, since = [], None, time.monotonic()
    for line in sys.stdin:
        sys.stdout.write(line)
        sys.stdout.flush()
        if begin := BEGINS.match(line):
            now = time.monotonic()
            if name:
                seconds.append((now - since, name))
            name, since = begin["doc"] or f"{begin['path']} ({begin['file'].rpartition('/')[2]})", now
    if name:
        seconds.append((time.monotonic() - since, name))
    with open(into, "w") as out:
        for duration, program in sorted(seconds, reverse=True):
            out.write(f"{duration:6.1f} s  {program}\n")


if __name__ == "__main__":
    main(sys.argv[1])
