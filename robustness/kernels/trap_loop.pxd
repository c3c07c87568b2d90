cimport cython
from robustness.kernels.shared cimport copy_state, core, most_promising, varint
from robustness.kernels.trap_rules cimport TrapRules, assume
from robustness.kernels.words cimport SOURCES, bit_of, count, first, number, word

cdef int P, Q, F, T, Z, NORMAL, MALICIOUS, ROOT, BRANCH, NODES, FAILED, PROBES
cdef int CLOSED, FOUND, PAUSED, FLUSH, GROW, STUCK, TRAPS_TRIED, _SOLVED, _NOTHING, _CONTRADICTION

@cython.final
cdef class TrapSearch:
    cdef public TrapRules rules
    cdef public bint look_ahead, eager
    cdef public word[:, :, ::1] stack
    cdef public number[::1] symmetric, counters, votes
    cdef public number level
    cdef public word[:, ::1] found, scratch
    cdef public number[:, ::1] scratch_margin
    cdef public number[::1] value, chosen
    cdef number side, node

    @cython.locals(words=number, found=word[:, ::1], side=number, other=number, w=number, free=word)
    cdef bint _harvest(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        n=number, words=number, votes=number[::1], most=number, side=number, v=number, w=number, x=number, i=number,
        inside=number, vote=number, rest=word, open_=word, known=word)
    cdef void _wanted(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        words=number, votes=number[::1], most=number, side=number, v=number, w=number, x=number, i=number, lack=number,
        vote=number, rest=word, open_=word)
    cdef void _pressing(self, word[:, ::1] state) noexcept nogil

    @cython.locals(side=number, w=number, rest=word)
    cdef void _any_open(self, word[:, ::1] state) noexcept nogil

    @cython.locals(total=number, w=number, side=number)
    cdef number _weight(self, word[:, ::1] state) noexcept nogil

    @cython.locals(kept=number[:, ::1], possible=bint)
    cdef bint _probe(self, word[:, ::1] state, number side, number v) noexcept nogil

    @cython.locals(
        chosen=number[::1], surplus=number, w=number, side=number, found=number, most=number, node=number,
        a=number, v=number, start=number, place=number, settled=number)
    cdef void _look_ahead(self, word[:, ::1] state) noexcept nogil

    @cython.locals(need=number[::1], chosen=number, w=number, v=number, rest=word)
    cdef number _highest_need(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        words=number, need=number[::1], chosen=number, least=number, w=number, v=number, x=number, spare=number,
        rest=word)
    cdef number _next_root(self, word[:, ::1] state) noexcept nogil

    cdef number _choose(self, word[:, ::1] state, bint symmetric) noexcept nogil

    @cython.locals(
        level=number, state=word[:, ::1], child=word[:, ::1], symmetric=bint, kind=number, opcode=number, place=number)
    cdef number _search(self, number quota, number room) noexcept nogil

    @cython.locals(granted=number, why=number, room=number)
    cpdef run(self, quota)
