#include "complain.h"

#include <stdarg.h>
#include <stdio.h>

esk_outcome esk_complain(esk_outcome outcome, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	fputs("eskel: ", stderr);
	vfprintf(stderr, format, arguments);
	fputc('\n', stderr);
	va_end(arguments);
	return outcome;
}
