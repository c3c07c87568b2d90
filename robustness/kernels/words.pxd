# The primitives of words.py as machine instructions.

ctypedef unsigned long long word
ctypedef Py_ssize_t number

cdef extern from *:
    """
    #if defined(_MSC_VER)
    #include <intrin.h>
    static __forceinline int words_count(unsigned long long x) { return (int)__popcnt64(x); }
    static __forceinline int words_first(unsigned long long x) {
        unsigned long place; _BitScanForward64(&place, x); return (int)place; }
    #else
    static inline int words_count(unsigned long long x) { return __builtin_popcountll(x); }
    static inline int words_first(unsigned long long x) { return __builtin_ctzll(x); }
    #endif
    #define words_bit(node) (1ULL << ((node) & 63))
    """
    number count "words_count"(word x) noexcept nogil
    number first "words_first"(word x) noexcept nogil
    word bit_of "words_bit"(number node) noexcept nogil

cdef extern from *:
    const char *SOURCES "ROBUSTNESS_SOURCES"
