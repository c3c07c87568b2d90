cimport cython
from robustness.kernels.words cimport SOURCES, number, word

cdef double _INFINITY
cdef word _ALL, _GOLDEN, _FIRST, _SECOND

@cython.locals(t=number, _=number, high=double, low=double, high_at=number, low_at=number)
cpdef void drop_extremes(
    double[::1] rel, number number_heard, number drop, bint strict, double[::1] above, double[::1] below,
    unsigned char[::1] keep) noexcept nogil

@cython.locals(
    slots=number, now=number, delay_row=number, status_row=number, heard=number, missing=number, e=number, state=number,
    late=number, value=double)
cdef (number, number) _listen(
    number b, number begin, number end, number step, number tau, double[:, :, ::1] ring,
    const long long[::1] channel, const long long[:, ::1] delay, const unsigned char[:, ::1] status, bint remember,
    double[:, ::1] memory, long long[:, ::1] stamp, double[::1] values, long long[::1] arcs) noexcept nogil

@cython.locals(
    half=double, b=number, i=number, e=number, t=number, update_row=number, begin=number, end=number, own=double,
    updates=bint, total=double, mass=double, heard=number, missing=number, u=double)
cdef void _advance(
    number lo, number hi, number step, number tau, number f, bint first_order, bint strict, bint hold, bint remember,
    double T, double[:, ::1] p, double[:, ::1] q, double[:, :, ::1] ring, const long long[::1] channel,
    const long long[:, ::1] delay, const unsigned char[:, ::1] status, const unsigned char[:, ::1] update,
    double[:, ::1] held, unsigned char[:, ::1] kept, double[:, ::1] memory, long long[:, ::1] stamp,
    const long long[::1] indptr, const double[::1] weight, const double[::1] self_weight, const double[::1] alpha,
    double[:, ::1] new_p, double[:, ::1] new_q, double[::1] values, double[::1] rel, double[::1] above,
    double[::1] below, long long[::1] arcs, unsigned char[::1] keep) noexcept nogil

@cython.locals(
    widest=number, i=number, values=double[::1], rel=double[::1], above=double[::1], below=double[::1],
    arcs=cython.longlong[::1], keep=cython.uchar[::1])
cpdef advance(
    number lo, number hi, number step, number tau, number f, bint first_order, bint strict, bint hold, bint remember,
    double T, double[:, ::1] p, double[:, ::1] q, double[:, :, ::1] ring, const long long[::1] channel,
    const long long[:, ::1] delay, const unsigned char[:, ::1] status, const unsigned char[:, ::1] update,
    double[:, ::1] held, unsigned char[:, ::1] kept, double[:, ::1] memory, long long[:, ::1] stamp,
    const long long[::1] indptr, const double[::1] weight, const double[::1] self_weight, const double[::1] alpha,
    double[:, ::1] new_p, double[:, ::1] new_q)

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
