"""Reading and writing topologies."""

from robustness.files.found import ReadingOptions
from robustness.files.front import (
    FORMAT_NAMES,
    FORMATS,
    SIZE_LIMIT,
    Format,
    decode_topology,
    encode_topology,
    names_of_graphs,
    read_topology,
    write_topology,
)
from robustness.files.writing import replace_file, write_certificate

__all__ = [
    "FORMATS",
    "FORMAT_NAMES",
    "SIZE_LIMIT",
    "Format",
    "ReadingOptions",
    "decode_topology",
    "encode_topology",
    "names_of_graphs",
    "read_topology",
    "replace_file",
    "write_certificate",
    "write_topology",
]
