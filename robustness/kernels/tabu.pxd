cimport cython
from robustness.kernels.passes cimport both_cores
from robustness.kernels.words cimport SOURCES, number, word

cdef word _FACTOR, _INCREMENT, _ALL_BITS

cdef word _draw(word state) noexcept nogil

@cython.final
cdef class Tabu:
    cdef const long long[::1] in_indptr, out_indptr
    cdef const int[::1] in_indices, out_indices
    cdef const long long[:, ::1] price
    cdef signed char[::1] side, kind
    cdef int[:, ::1] inside, rise, fall
    cdef int[::1] outside, paying, place
    cdef number[::1] size, exposed, until
    cdef number n, r, s, fee, least, count, cost
    cdef word luck

    @cython.locals(i=number, k=number)
    cdef void _count_all(self) noexcept nogil

    @cython.locals(k=number)
    cdef void _tell(self, number i, number side, number up, number down) noexcept nogil

    cdef void _expose(self, number i, number side) noexcept nogil

    @cython.locals(last=number)
    cdef void _cover(self, number i, number side) noexcept nogil

    @cython.locals(t=number, x=number, before=number, now=number, after=number)
    cdef void _enter(self, number i, number side) noexcept nogil

    @cython.locals(x=number, before=number, now=number, after=number)
    cdef void _leave(self, number i, number side) noexcept nogil

    @cython.locals(
        luck=word, current=number, mover=number, goal=number, gain=number, ties=number, begin=number, end=number,
        own=number, k=number, v=number, a=number, b=number, degree=number, leave=number, change=number)
    cdef (number, number) _best_move(self, number u, number step, number best) noexcept nogil

    @cython.locals(
        a=number, k=number, i=number, c=number, t=number, x=number, y=number, old_before=number, old=number,
        old_after=number, before=number, now=number, after=number)
    cdef void _move(self, number v, number b) noexcept nogil

    @cython.locals(best=number, step=number, i=number, v=number, b=number)
    cpdef bint run(
        self, number steps, number tenure, word seed, unsigned char[::1] first, unsigned char[::1] second)
