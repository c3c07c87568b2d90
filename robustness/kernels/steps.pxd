cimport cython
from robustness.kernels.words cimport SOURCES, number, word

cdef double _INFINITY
cdef word _ALL, _GOLDEN, _FIRST, _SECOND

@cython.locals(t=number, _=number, high=double, low=double, high_at=number, low_at=number)
cpdef void drop_extremes(
    double[::1] rel, number number_heard, number drop, bint strict, double[::1] above, double[::1] below,
    unsigned char[::1] keep) noexcept nogil

@cython.final
cdef class Turn:
    cdef number step, tau, f
    cdef bint first_order, strict, hold, remember
    cdef double T
    cdef const long long[::1] indptr, channel
    cdef const double[::1] weight, alpha
    cdef const double[:, :, ::1] ring
    cdef const long long[:, ::1] delay
    cdef const unsigned char[:, ::1] status, update
    cdef double[:, ::1] held, memory
    cdef unsigned char[:, ::1] kept
    cdef long long[:, ::1] stamp
    cdef const double[:, ::1] p, q
    cdef double[:, ::1] new_p, new_q
    cdef double[::1] values, rel, above, below
    cdef long long[::1] arcs
    cdef unsigned char[::1] keep

    @cython.locals(
        slots=number, now=number, delay_row=number, status_row=number, heard=number, missing=number, e=number,
        state=number, late=number, value=double)
    cdef (number, number) _listen(self, number b, number begin, number end) noexcept nogil

    @cython.locals(t=number, e=number, total=double, mass=double)
    cdef (double, double) _pull(self, number b, number i, double own, number heard, number missing) noexcept nogil

    @cython.locals(
        half=double, b=number, i=number, e=number, update_row=number, own=double, speed=double, updates=bint,
        total=double, mass=double, heard=number, missing=number, u=double)
    cdef void _advance(self, number lo, number hi) noexcept nogil

    @cython.locals(first=number, last=number)
    cpdef advance(self, lo, hi)

@cython.locals(
    slots=number, now=number, b=number, e=number, place=number, up=bint, chosen=number, best=double, late=number,
    value=double)
cpdef worst_delays(
    number step, number bound, double[:, :, ::1] ring, const long long[::1] channel, const long long[::1] heads,
    const unsigned char[:, ::1] above, long long[:, ::1] delays)

@cython.locals(b=number, j=number, counter=word, mixed=word, top=word)
cpdef fill_uniform(const word[::1] stream, double[:, ::1] values)

@cython.locals(b=number, i=number, lo=double, hi=double, quick=double, value=double, fast=double)
cpdef extremes(
    double[:, ::1] p, double[:, ::1] q, const unsigned char[:, ::1] normal, double[::1] low, double[::1] high,
    double[::1] fastest)
