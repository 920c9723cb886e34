"""Packets of one client of a robot's network, kept and sent again from somewhere else.

    replay.py record DOMAIN PACKETS      in a network of its own, on whose loopback the client and the robot are; root
    replay.py send DOMAIN PACKETS HOST   until it is ended

Nothing secret is needed: the client announces itself and its writer again, addressed to anybody, and the robot believes it.
"""

import json
import signal
import socket
import sys
import time

# Where a participant of a domain receives, by the standard's numbers: announcements and data, by multicast and by unicast of the
# first two participants.
PORTS = [0, 1, 10, 11, 12, 13]
INFO_DST, CYCLONE = 0x0E, b"\x01\x10"


def ports(domain):
    return [7400 + 250 * domain + port for port in PORTS]


def to_anybody(packet):
    """The same, addressed to no participant by its name."""
    packet, at = bytearray(packet), 20
    while at + 4 <= len(packet):
        kind, flags = packet[at], packet[at + 1]
        length = int.from_bytes(packet[at + 2 : at + 4], "little" if flags & 1 else "big")
        if kind == INFO_DST:
            packet[at + 4 : at + 16] = bytes(12)
        if length == 0:
            break
        at += 4 + length
    return bytes(packet)


def record(domain, path):
    """Keeps what a client by Cyclone DDS sends to the robot."""
    ears = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.ntohs(0x0800))
    ears.bind(("lo", 0))
    ears.settimeout(0.2)
    going, packets = [True], []
    signal.signal(signal.SIGTERM, lambda *_: going.clear())
    print("records", flush=True)
    while going:
        try:
            packet = ears.recv(65535)
        except TimeoutError:
            continue
        head = 4 * (packet[0] & 15)
        udp, payload = packet[head : head + 8], packet[head + 8 :]
        if packet[9] == 17 and payload[:4] == b"RTPS" and payload[6:8] == CYCLONE:
            if int.from_bytes(udp[2:4], "big") in ports(domain):
                packets.append(to_anybody(payload).hex())
    with open(path, "w", encoding="utf-8") as file:
        json.dump(packets, file)


def send(domain, path, host):
    """Sends it all, again and again: to every port, as the first and the second participant have it."""
    with open(path, encoding="utf-8") as file:
        packets = [bytes.fromhex(packet) for packet in json.load(file)]
    mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    first = True
    while True:
        for packet in packets:
            for port in ports(domain):
                try:
                    mouth.sendto(packet, (host, port))
                except OSError as error:
                    # Nobody may listen to a port yet, or any more.
                    if not isinstance(error, ConnectionError):
                        raise
            time.sleep(0.002)
        if first:
            print(f"{len(packets)} packets", flush=True)
            first = False


if __name__ == "__main__":
    way, domain, *rest = sys.argv[1:]
    {"record": record, "send": send}[way](int(domain), *rest)
