/* Loops over eight of a kind, which compilers turn into vector code: an array's last index is the lane. */
#ifndef ESK_LANES_H
#define ESK_LANES_H

enum { ESK_LANES = 8 };

typedef double esk_lanes[ESK_LANES] __attribute__((aligned(64))); /* a cache line */

#define ESK_EACH_LANE(l) _Pragma("omp simd") for (int l = 0; l < ESK_LANES; l++)

/* Compiles a function for each width of vectors that processors have; the widest one there is runs. Lanes do not mix and
 * nothing is fused, so all of them find the same bits. Not under sanitizers: the choice is made when the program is
 * loaded, before their run time is up. Not by clang, which gives such a function another name than its callers expect.
 * With ESK_ONE_WIDTH for what the compiler is told to use, so that tests can compare. */
#if defined(__x86_64__) && !defined(ESK_ONE_WIDTH) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
	!defined(__SANITIZE_THREAD__)
#define ESK_EVERY_WIDTH __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ESK_EVERY_WIDTH
#endif

/* A part of such a function: by itself it would be compiled for the narrowest width. */
#define ESK_IN_LANES static inline __attribute__((always_inline))

#endif
