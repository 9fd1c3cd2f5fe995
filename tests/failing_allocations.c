#include "failing_allocations.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>

static atomic_long left = -1; /* before one fails; -1: none fails */

void failing_allocations_begin(long made)
{
	left = made;
}

bool failing_allocations_end(void)
{
	return atomic_exchange(&left, -1) < 0;
}

bool failing_allocations_next(void)
{
	long before = left;
	while (before >= 0 && !atomic_compare_exchange_weak(&left, &before, before - 1))
		;
	return before == 0;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
char *__real_strdup(const char *text);
int __real_vasprintf(char **text, const char *format, va_list arguments);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
char *__wrap_strdup(const char *text);
int __wrap_vasprintf(char **text, const char *format, va_list arguments);

void *__wrap_malloc(size_t size)
{
	return failing_allocations_next() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
	return failing_allocations_next() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
	return failing_allocations_next() ? NULL : __real_realloc(old, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
	return failing_allocations_next() ? NULL : __real_aligned_alloc(alignment, size);
}

char *__wrap_strdup(const char *text)
{
	return failing_allocations_next() ? NULL : __real_strdup(text);
}

int __wrap_vasprintf(char **text, const char *format, va_list arguments)
{
	return failing_allocations_next() ? -1 : __real_vasprintf(text, format, arguments);
}
