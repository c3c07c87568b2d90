cimport cython
from robustness.kernels.words cimport SOURCES, bit_of, count, number, word

cdef number EXHAUSTIVE_NODES, _NO_PAIR

@cython.locals(i=number)
cpdef bint by_degree(word[::1] hears, number size, number r)

@cython.locals(outside=word, members=number, exempt=number, i=number)
cdef number _exempt(word[::1] hears, number size, number r, word side)

@cython.locals(last=word, k=number, first=word, second=word)
cdef bint _violated_again(word[::1] hears, number size, number r, number s, word[::1] pair)

@cython.locals(i=number)
cdef bint _proven(
    word[::1] hears, number size, number r, number s, word[::1] pair, object examine) except *

@cython.locals(bits=word, k=number, j=number, q=number)
cdef (number, word) _join(
    const long long[::1] indptr, const int[::1] indices, int[::1] seed, number size, int[::1] links, int[::1] met,
    number known)

@cython.locals(q=number, k=number, best=number, most=number)
cdef number _most_linked(int[::1] seed, number size, int[::1] links, int[::1] met, number known)

@cython.locals(
    links=int[::1], met=int[::1], hears=word[::1], pair=word[::1], tried=number, fresh=number, size=number,
    known=number, found=bint, heard_by=word, q=number, k=number, degree=number)
cpdef find_seed(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr,
    const int[::1] out_indices, int[::1] anchors, unsigned char[::1] barred, number r, number s, number limit,
    number work, int[::1] seed, object examine)
