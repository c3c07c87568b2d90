"""A long refutation verified by several processes: each walks through the tree but for the parts that others have.

An *index* lists trees within a transcript: at which byte after the header each begins, and its length; ascending, none
inside another. It is a hint, and no part of the certificate. Of ``count`` shares each has some of these trees as its
own. It walks through all that is in no tree of the index and through its own trees, and passes over the others, as many
bytes as the index says; that its own have the length said, it checks.

Theorem. When all shares of a certificate, with one index, are accepted, it proves its claim. Proof. Take the walk
through the whole transcript, in one process, and let all be well up to the k-th tree of the index that it meets. So
far every share was where this walk is, with the same states, since what they passed over was the k - 1 trees before,
which their owners have walked through from the same states to the end that the index says. A tree is met when a
settled state is not contradictory, and so takes at least one byte: no two states meet it. Its owner accepts it, so
the whole walk goes through it, to the end that the index says, and all is well up to the next. Behind the last all
shares walk as it does. A tree of the index that the walk does not meet, no share passes over.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from certificates.envelope import shown
from certificates.errors import MalformedCertificate, Misuse, RejectedCertificate
from certificates.masks import MAX_LOOKS
from certificates.questions import format_of
from certificates.stream import Blocks, Stream
from certificates.tolerance import FORMATS as TOLERANCE_FORMATS
from certificates.tolerance import VerifiedToleranceClaim, prove_tolerance
from certificates.verification import FORMAT, VerifiedClaim, prove

__all__ = ["Index", "Share", "together", "verify_share"]

#: Beginnings and lengths of trees.
Index = Sequence[tuple[int, int]]


@dataclass(frozen=True, slots=True)
class Share:
    """That one share was accepted: of which certificate, by which index. Alone it proves nothing."""

    claim: VerifiedClaim | VerifiedToleranceClaim
    sha256: str
    index: tuple[tuple[int, int], ...]
    number: int
    count: int
    #: Of the tree nodes in ``claim``, those in the share's own trees.
    own_nodes: int
    #: Looks at nodes that were made, and those of them for the share's own trees.
    looks: int
    own_looks: int
    #: The trees that it met the end of, as :class:`certificates.stream.Stream` lists them: no part of what is proved.
    trees: tuple[tuple[int, int], ...]


def verify_share(graph_bytes: bytes, certificate_bytes: Blocks, index: Index, number: int, count: int) -> Share:
    """Verify share ``number`` of ``count`` of an ordinary certificate, or of one of tolerance.

    Raises
    ------
    Misuse
        For an index or a number that is none, or a certificate of another kind.
    CertificateError
        As the verifiers do. A rejection may be the fault of the index.
    """
    trees = tuple((start, length) for start, length in index)
    ends = [(0, 0), *trees]
    if not all(a + b <= c and d > 0 for (a, b), (c, d) in pairwise(ends)) or not 0 <= number < count:
        raise Misuse("an index is ascending trees, none inside another, and shares are numbered from 0")
    sha256 = hashlib.sha256()
    stream = Stream(_hashed(Stream.of(certificate_bytes), sha256))
    stream.trees = []
    loads = [0] * count
    for start, length in sorted(trees, key=lambda tree: (-tree[1], tree)):
        owner = loads.index(min(loads))
        loads[owner] += length
        stream.share[start] = length, owner == number
    found = format_of(stream)
    claim: VerifiedClaim | VerifiedToleranceClaim
    if found == FORMAT:
        claim = prove(graph_bytes, stream)
    elif found in TOLERANCE_FORMATS:
        claim = prove_tolerance(graph_bytes, stream)
    else:
        raise Misuse(f"a certificate of the format {shown(found)} has no shares")
    looks = stream.looks, stream.own_looks
    return Share(claim, sha256.hexdigest(), trees, number, count, stream.own_nodes, *looks, tuple(stream.trees))


def together(shares: Sequence[Share]) -> VerifiedClaim | VerifiedToleranceClaim:
    """Return the claim that all shares prove together.

    Raises
    ------
    RejectedCertificate
        When they are not all the shares of one certificate by one index.
    MalformedCertificate
        When they took more looks at nodes together than one verifier would take upon itself.
    """
    claims = {replace(share.claim, tree_nodes=0) for share in shares}
    same = {(share.sha256, share.index, share.count) for share in shares}
    if len(claims) != 1 or len(same) != 1 or {each.number for each in shares} != set(range(shares[0].count)):
        raise RejectedCertificate("these are not all the shares of one certificate")
    (claim,) = claims
    top = shares[0].claim.tree_nodes - shares[0].own_nodes
    own = {share.number: (share.own_nodes, share.own_looks) for share in shares}
    nodes, looks = map(sum, zip(*own.values(), strict=True))
    if shares[0].looks - shares[0].own_looks + looks > MAX_LOOKS:
        raise MalformedCertificate(f"a refutation may ask for at most {MAX_LOOKS} looks at nodes")
    return replace(claim, tree_nodes=top + nodes)


def _hashed(blocks: Stream, sha256: hashlib._Hash) -> Iterator[bytes]:
    for block in blocks:
        sha256.update(block)
        yield block
