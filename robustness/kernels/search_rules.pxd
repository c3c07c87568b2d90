cimport cython
from robustness.kernels.shared cimport varint
from robustness.kernels.words cimport bit_of, SOURCES, count, first, number, word

cdef int C, P, F, T, PROPAGATE, EXCLUDE, SATISFIED

@cython.locals(w=number, bit=word)
cpdef void assume(word[:, ::1] state, number kind, number side, number node, bint true) noexcept nogil

@cython.final
cdef class Rules:
    cdef public number n, words, spare, blockers, place
    cdef public bint sharing
    cdef public word[:, ::1] hears, reach
    cdef public number[::1] need, slack, blocker, allowed
    cdef public number[:, ::1] margin
    cdef public word[::1] trial
    cdef public unsigned char[::1] buffer

    @cython.locals(
        words=number, trial=word[::1], hears=word[:, ::1], t=number, w=number, x=number, i=number, inside=number,
        extra=number, rest=word, sure=word, changed=bint, some=bint, all_kept=bint)
    cdef number _least_spare(self, word[:, ::1] state, number left, number side) noexcept nogil

    @cython.locals(
        words=number, hears=word[:, ::1], need=number[::1], allowed=number[::1], left=number, w=number, x=number,
        i=number, side=number, spared=number, inside=number, extra=number, usable=number, fair=number, rest=word,
        bit=word, wanted=word, changed=bint, some=bint)
    cdef number _settle(self, word[:, ::1] state) noexcept nogil

    @cython.locals(
        hears=word[:, ::1], reach=word[:, ::1], most=number, w=number, x=number, i=number, slack=number, rest=word)
    cdef number _gather_blockers(self, word[:, ::1] state, number side) noexcept nogil

    @cython.locals(
        words=number, other=number, hears=word[:, ::1], reach=word[:, ::1], most=number, found=number, w=number,
        x=number, a=number, j=number, have=number, gain=number, next_gain=number, one=number, two=number, value=number,
        rest=word, bit=word)
    cdef number _exclude(self, word[:, ::1] state, number left, number side) noexcept nogil

    cdef void _note_exclusion(self, number side, number node, number one, number two) noexcept nogil

    @cython.locals(left=number, excluded=number, found=number, side=number)
    cpdef number propagate(self, word[:, ::1] state) noexcept nogil
