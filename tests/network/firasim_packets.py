"""FIRASim's packets as its clients write and read them, with protobuf's encoding written out (protobuf.dev, "Encoding").

Names and numbers of the fields are in proto/firasim.proto.
"""
import struct

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5


def varint(number):
    encoded = bytearray()
    while number > 0x7F:
        encoded.append(number & 0x7F | 0x80)
        number >>= 7
    encoded.append(number)
    return bytes(encoded)


def fields(message):
    """Pairs of field number and value: an integer, a double or bytes."""
    at = 0

    def read_varint():
        nonlocal at
        number = shift = 0
        while True:
            number |= (message[at] & 0x7F) << shift
            at += 1
            if message[at - 1] < 0x80:
                return number
            shift += 7

    while at < len(message):
        key = read_varint()
        kind = key & 7
        if kind == VARINT:
            value = read_varint()
        elif kind == FIXED64:
            value, at = struct.unpack_from("<d", message, at)[0], at + 8
        elif kind == BYTES:
            size = read_varint()
            value, at = message[at:at + size], at + size
        else:
            raise ValueError(f"FIRASim has no field of wire type {kind}")
        yield key >> 3, value


def read_object(message, names):
    """A ball or robot: a dictionary of all names. Proto3 leaves zeros out."""
    found = dict(fields(message))
    return {name: found.get(number, 0) for number, name in enumerate(names, 1)}


def read_environment(message):
    """Ball (None if it is absent) and robots by color and id."""
    ball, robots = None, {"yellow": {}, "blue": {}}
    for number, value in fields(dict(fields(message))[2]):
        if number == 1:
            ball = read_object(value, ("x", "y", "z", "vx", "vy", "vz"))
        else:
            robot = read_object(value, ("id", "x", "y", "theta", "vx", "vy", "w"))
            robots["yellow" if number == 2 else "blue"][robot["id"]] = robot
    return ball, robots


def command(robot_id, yellow, wheel_left, wheel_right):
    """A Command; wheels in rad/s. Proto3 leaves zeros out."""
    encoded = b""
    for number, value in ((1, robot_id), (2, int(yellow))):
        if value != 0:
            encoded += varint(number << 3 | VARINT) + varint(value)
    for number, value in ((6, wheel_left), (7, wheel_right)):
        if value != 0:
            encoded += varint(number << 3 | FIXED64) + struct.pack("<d", value)
    return encoded


def packet(commands):
    """A Packet with the commands in cmd.robot_commands."""

    def embedded(message):
        return varint(1 << 3 | BYTES) + varint(len(message)) + message

    return embedded(b"".join(embedded(one) for one in commands))
