/* Lets one allocation of the program fail, in whichever thread: for tests that are linked with --wrap for malloc, calloc,
 * realloc, aligned_alloc, strdup and vasprintf (eskel_fail_allocations in unit/CMakeLists.txt). */
#ifndef FAILING_ALLOCATIONS_H
#define FAILING_ALLOCATIONS_H

#include <stdbool.h>

/* From now on: the one after as many that are made. */
void failing_allocations_begin(long made);
/* No more; whether it has failed. */
bool failing_allocations_end(void);
/* For allocators that are not wrapped: true for the one that must fail. */
bool failing_allocations_next(void);

#endif
