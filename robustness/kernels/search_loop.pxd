cimport cython
from robustness.kernels.words cimport bit_of, SOURCES, count, first, number, word
from robustness.kernels.search_rules cimport Rules, assume
from robustness.kernels.shared cimport copy_state, core, most_promising, varint

cdef int C, P, F, T, ROOT, BRANCH, SATISFIED, MEMBER, PENDING, SYMMETRIC, GIVEN, NODES, FAILED, PROBES
cdef int CLOSED, FOUND, PAUSED, FLUSH, GROW, DONATED, STUCK, TRIED, _PAIR, _NOTHING, _CONTRADICTION

@cython.final
cdef class Search:
    cdef public Rules rules
    cdef public bint look_ahead
    cdef public word[:, :, ::1] stack
    cdef public number[:, ::1] table, scratch_margin
    cdef public number level
    cdef public number[::1] counters, value, chosen
    cdef public word[:, ::1] pair, scratch
    cdef public word[::1] nobody
    cdef number side, node

    @cython.locals(pair=word[:, ::1], nobody=word[::1], side=number, other=number, w=number)
    cdef bint _harvest(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        hears=word[:, ::1], need=number[::1], words=number, side=number, w=number, x=number, i=number, inside=number,
        rest=word, open_=word)
    cdef void _undetermined(self, word[:, ::1] state) noexcept nogil

    @cython.locals(total=number, w=number, side=number)
    cdef number _weight(self, word[:, ::1] state) noexcept nogil

    @cython.locals(kept=number[:, ::1], left=number)
    cdef bint _probe(self, word[:, ::1] state, number side, number v) noexcept nogil

    @cython.locals(
        chosen=number[::1], surplus=number, w=number, side=number, found=number, most=number, node=number,
        a=number, v=number, start=number, place=number, settled=number)
    cdef void _look_ahead(self, word[:, ::1] state) noexcept nogil

    @cython.locals(need=number[::1], chosen=number, w=number, v=number, rest=word)
    cdef number _highest_need(self, word[:, ::1] state, bint both) noexcept nogil

    cdef number _choose(self, word[:, ::1] state, bint symmetric) noexcept nogil

    @cython.locals(
        table=number[:, ::1], counters=number[::1], level=number, state=word[:, ::1], child=word[:, ::1],
        symmetric=bint, kind=number, opcode=number, place=number)
    cdef number _search(self, number quota, number room) noexcept nogil

    @cython.locals(room=number, granted=number, why=number)
    cpdef run(self, quota)
