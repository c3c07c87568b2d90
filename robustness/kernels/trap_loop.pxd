cimport cython
from robustness.kernels.search_rules cimport copy_state, core, varint
from robustness.kernels.trap_rules cimport TrapRules, assume
from robustness.kernels.words cimport SOURCES, bit_of, count, first, number, word

cdef int P, Q, F, T, Z, NORMAL, MALICIOUS, ROOT, BRANCH, NODES, FAILED, PROBES
cdef int CLOSED, FOUND, PAUSED, FLUSH, GROW, STUCK, _SOLVED, _NOTHING, _CONTRADICTION

@cython.final
cdef class TrapSearch:
    cdef public TrapRules rules
    cdef public bint look_ahead, eager
    cdef public word[:, :, ::1] stack
    cdef public number[::1] symmetric, counters, votes
    cdef public number level
    cdef public word[:, ::1] found, scratch
    cdef public number[:, ::1] shrink
    cdef number side, node

    @cython.locals(words=number, found=word[:, ::1], side=number, other=number, w=number, free=word)
    cdef bint _harvest(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        n=number, words=number, votes=number[::1], most=number, side=number, v=number, w=number, x=number, i=number,
        inside=number, vote=number, rest=word, open_=word, known=word)
    cdef void _wanted(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        words=number, votes=number[::1], most=number, side=number, v=number, w=number, x=number, i=number, rest=word,
        open_=word)
    cdef void _pressing(self, word[:, ::1] state) noexcept nogil

    @cython.locals(side=number, w=number, rest=word)
    cdef void _any_open(self, word[:, ::1] state) noexcept nogil

    @cython.locals(total=number, w=number, side=number)
    cdef number _weight(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        words=number, shrink=number[:, ::1], weight=number, some=bint, failed=bint, w=number, v=number, side=number,
        rest=word, score=number, best=number, chosen=number, start=number, place=number)
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
