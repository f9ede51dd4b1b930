#!/usr/bin/env python3
# The smallest client of Crepitus. All that it knows stands in docs/protocol.md.
#
#     python3 docs/examples/client.py /dev/ttyACM0 [--arm]        (or - for stdin and stdout, or the socket of a
#                                                                  program that has the port open)
#
# It says hello, opens a session, sets crepitus.static_torque_nm to 0.45, receives
# 200 blocks of samples, and checks that each sample was received or is reported as
# dropped. With --arm the device is armed meanwhile, with the angle's zero here.
import itertools, os, select, socket, stat, struct, sys, tty, zlib

# --- Framing ---

def cobs(data):
    runs = (part[i : i + 254] for part in data.split(b"\0") for i in range(0, len(part) + 1, 254))
    return b"".join(bytes([len(run) + 1]) + run for run in runs)

def uncobs(coded):
    run, rest = coded[1 : coded[0]], coded[coded[0] :]
    return run + (b"\0" * (len(run) < 254) + uncobs(rest) if rest else b"")

def send(body):  # The first delimiter ends whatever was on the wire before.
    os.write(sink, b"\0" + cobs(body + struct.pack("<I", zlib.crc32(body))) + b"\0")

def receive(rest=b""):  # Ends after two seconds of silence.
    while select.select([source], [], [], 2.0)[0]:
        *frames, rest = (rest + (os.read(source, 4096) or sys.exit("the port is closed"))).split(b"\0")
        yield from (p[:-4] for p in map(uncobs, filter(None, frames)) if struct.pack("<I", zlib.crc32(p[:-4])) == p[-4:])

def wait_for(start):  # The rest of the next body that begins so, byte by byte.
    body = next((body for body in bodies if body.startswith(start)), None) or sys.exit("no answer")
    return iter(body[len(start) :])

# --- Messages ---

def varint(number):
    return bytes([number]) if number < 128 else bytes([number % 128 + 128]) + varint(number >> 7)

def unvarint(message):
    return byte if (byte := next(message)) < 128 else byte - 128 + (unvarint(message) << 7)

def request(what):
    number = varint(next(numbers))
    send(b"Q" + tag + session + nonce + number + what)
    reply = wait_for(b"R" + tag + session + number)
    refused, answer = next(reply), next(reply)
    return reply if not refused else sys.exit(f"refused: {answer} {bytes(reply).hex()}")

def opened(path):
    if not stat.S_ISSOCK(os.stat(path).st_mode):
        return os.open(path, os.O_RDWR | os.O_NOCTTY)
    (hub := socket.socket(socket.AF_UNIX)).connect(path)
    return hub.detach()

source, sink = (0, 1) if sys.argv[1] == "-" else (opened(sys.argv[1]),) * 2
os.isatty(source) and tty.setraw(source)
bodies, numbers, session, nonce = receive(), itertools.count(1), varint(int.from_bytes(os.urandom(4), "little")), b"\0"

# Hello. A client that does more compares the hash, bytes 4 to 11, with the one it was made for.
send(b"M1H\x2a")
tag = bytes(wait_for(b"m1H\x2a"))[4:5] or sys.exit("the answer is too short")

# The session's nonce is in each further request.
nonce = bytes(request(b"\x0c"))

# Ask for the status until the drive is there and has its parameters.
present, revision, in_force = 0, 0, None
while not present or revision != in_force:
    status = request(b"\x01")
    state, drive_fault, comms_fault, present = (next(status) for _ in range(4))
    tick, uptime_ms, revision, in_force = (unvarint(status) for _ in range(4))

# All parameters at once, on top of the revision that they were made from.
parameters = request(b"\x03")
base, values = unvarint(parameters), [value for value, in struct.iter_unpack("<d", bytes(parameters))]
values[4] = 0.45
request(b"\x04" + varint(base) + struct.pack(f"<{len(values)}d", *values))

arms = "--arm" in sys.argv and [request(b"\x06"), request(b"\x07")] is not None
first_tick, dropped_before = (unvarint(answer) for answer in [request(b"\x0a")] * 2)
for number in range(1, 201):
    arms and number % 50 == 1 and send(b"Q" + tag + session + nonce + varint(next(numbers)) + b"\0")  # Renews the lease.
    tick = 0
    while tick < first_tick:  # Blocks of before, for another program's subscription.
        block = wait_for(b"T" + tag)
        sequence, tick, revision, dropped = (unvarint(block) for _ in range(4))
    assert tick + 20 - first_tick == 20 * number + dropped - dropped_before, "samples are missing from the accounting"
print("count %d, model %g N·m, torque %g N·m, %d mA, flags %#06x" % struct.unpack("<iffhH", bytes(block)[-56:-40]))
arms and request(b"\x08")
