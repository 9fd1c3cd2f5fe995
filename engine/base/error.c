#include "error.h"

#include <stdarg.h>
#include <stdio.h>

#define STATUS_TEXT(code, text) [code] = text,
static const char *const status_texts[ESKEL_STATUS_COUNT] = {ESKEL_STATUSES(STATUS_TEXT)};

#define WARNING_NAME(code, name) [code] = name,
static const char *const warning_names[ESKEL_WARNING_COUNT] = {ESKEL_WARNINGS(WARNING_NAME)};

const char *eskel_status_text(eskel_status status)
{
	if ((unsigned)status >= ESKEL_STATUS_COUNT)
		return "an unknown status";
	return status_texts[status];
}

const char *eskel_warning_name(eskel_warning_code code)
{
	if ((unsigned)code >= ESKEL_WARNING_COUNT)
		return "unknown";
	return warning_names[code];
}

eskel_status esk_error_set(eskel_error *error, eskel_status status, const char *format, ...)
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
