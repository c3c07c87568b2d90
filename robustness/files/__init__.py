"""Reading and writing topologies."""

from robustness.files.front import (
    FORMATS,
    SIZE_LIMIT,
    Format,
    decode_topology,
    encode_topology,
    read_topology,
    write_topology,
)
from robustness.files.writing import replace_file

__all__ = [
    "FORMATS",
    "SIZE_LIMIT",
    "Format",
    "decode_topology",
    "encode_topology",
    "read_topology",
    "replace_file",
    "write_topology",
]
