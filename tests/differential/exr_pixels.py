"""What an .exr shows: its channels and its chunks of pixels, without what else the header says."""

import struct
from pathlib import Path

MAGIC = 0x01312F76
MULTI_PART = 1 << 12
SHOWN = {b"channels", b"dataWindow", b"lineOrder", b"compression", b"chunkCount", b"name"}


def _word(content, at):
    end = content.index(b"\0", at)
    return content[at:end], end + 1


def _header(content, at):
    """Attributes of one part, and where it ends."""
    attributes = {}
    while content[at]:
        name, at = _word(content, at)
        _, at = _word(content, at)  # its type
        size, = struct.unpack_from("<i", content, at)
        attributes[name] = content[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def of(file):
    """Equal for two files that show the same, bit for bit, in the same layout."""
    content = Path(file).read_bytes()
    magic, version = struct.unpack_from("<II", content, 0)
    if magic != MAGIC:
        raise ValueError(f"{file}: expected an .exr")
    headers, at = [], 8
    while True:
        attributes, at = _header(content, at)
        headers.append(attributes)
        if not version & MULTI_PART or not content[at]:
            break
    at += bool(version & MULTI_PART)
    first, = struct.unpack_from("<Q", content, at)  # behind the table of where chunks are
    return [{name: part[name] for name in SHOWN & part.keys()} for part in headers], content[first:]
