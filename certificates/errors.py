"""What can go wrong when a certificate is checked: three different things, never to be confused.

::

    CertificateError (Exception)
    ├── Misuse (also TypeError)                the caller passed something that is not bytes
    ├── MalformedCertificate (also ValueError) the certificate is not of the format, or exceeds its limits
    │   └── MalformedGraph                     the graph is not of the format
    └── RejectedCertificate (also ValueError)  well-formed, but it does not prove its claim about this graph
"""

from __future__ import annotations

__all__ = ["CertificateError", "MalformedCertificate", "MalformedGraph", "Misuse", "RejectedCertificate"]


class CertificateError(Exception):
    """Any reason why no claim was verified."""


class Misuse(CertificateError, TypeError):
    """The caller passed an argument of the wrong type."""


class MalformedCertificate(CertificateError, ValueError):
    """The bytes are not a certificate of the format, or exceed its limits."""


class MalformedGraph(MalformedCertificate):
    """The bytes are not a graph of the format."""


class RejectedCertificate(CertificateError, ValueError):
    """A well-formed certificate that does not prove its claim about this graph.

    Attributes
    ----------
    code : str
        Which part does not hold, in one of the words of docs/certificate-format.md: for programs, as the text is for
        people and may change. "unproven" when another checker says no more.
    """

    def __init__(self, text: str, code: str = "unproven") -> None:
        super().__init__(text, code)
        self.code = code

    def __str__(self) -> str:
        return str(self.args[0])
