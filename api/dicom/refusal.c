#include "refusal.h"

#include <stdarg.h>
#include <stdio.h>

eskel_status esk_refuse(eskel_error *error, eskel_status status, const char *format, ...)
{
	if (error) {
		va_list arguments;
		va_start(arguments, format);
		error->status = status;
		vsnprintf(error->text, sizeof error->text, format, arguments);
		va_end(arguments);
	}
	return status;
}
