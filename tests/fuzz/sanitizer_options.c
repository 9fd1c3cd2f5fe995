/* For speed: memory that was freed is used again while it is still in a cache, and of who asked for memory less is kept. A
 * replay under the sanitizer's own options tells more of what was found. */
#include "fuzz.h"

const char *__asan_default_options(void);

const char *__asan_default_options(void)
{
	return "quarantine_size_mb=2:malloc_context_size=2";
}
