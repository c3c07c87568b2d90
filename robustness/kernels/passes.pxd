cimport cython
from robustness.kernels.words cimport SOURCES, number

@cython.locals(n=number, i=number, k=number, start=number[::1], place=number[::1], rows=int[::1])
cpdef transpose(const long long[::1] indptr, const int[::1] indices)

@cython.locals(
    n=number, i=number, k=number, top=number, size=number, gone=number, outside=int[::1], stack=int[::1])
cpdef number core(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr, const int[::1] out_indices,
    unsigned char[::1] member, number r)

@cython.locals(wanted=number, i=number)
cpdef bint both_cores(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr, const int[::1] out_indices,
    signed char[::1] side, number r, unsigned char[::1] first, unsigned char[::1] second)

@cython.locals(done=number, node=number, k=number, i=number)
cpdef number grow(
    const long long[::1] out_indptr, const int[::1] out_indices, unsigned char[::1] present, int[::1] heard,
    int[::1] order, number size, number need)

@cython.locals(done=number, k=number)
cpdef forget(
    const long long[::1] out_indptr, const int[::1] out_indices, unsigned char[::1] present, int[::1] heard,
    int[::1] order, number size)

@cython.locals(done=number, node=number, k=number, i=number)
cpdef number breadth_first(
    const long long[::1] indptr, const int[::1] indices, number start, int[::1] order, unsigned char[::1] seen,
    number size)

@cython.locals(n=number, seen=cython.uchar[::1], order=int[::1], last=number, size=number, start=number)
cpdef number mother(const long long[::1] out_indptr, const int[::1] out_indices)

@cython.locals(
    n=number, i=number, k=number, fresh=double[::1], total=double, weight=double, largest=double, acc=double,
    degree=number)
cpdef smooth(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr, const int[::1] out_indices,
    double[::1] values, number rounds)

@cython.locals(
    n=number, before=cython.uchar[::1], across=int[::1], fewest=number[::1], bad=number, place=number, node=number,
    k=number, i=number, part=number)
cpdef sweep(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr, const int[::1] out_indices,
    int[::1] order, number r, long long[::1] cuts)

@cython.locals(
    n=number, depth=int[::1], low=int[::1], parent=int[::1], after=number[::1], root=number, node=number,
    children=number, i=number, above=number)
cpdef number articulation(const long long[::1] indptr, const int[::1] indices)

@cython.locals(
    n=number, inside=int[::1], member=cython.uchar[::1], tried=number, size=number, satisfied=number, i=number, j=number,
    k=number, q=number, joins=number, least=number, lacks=number)
cpdef clump(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr, const int[::1] out_indices,
    int[::1] anchors, number limit, number r, int[::1] members)
