/* CSV as in RFC 4180: fields apart by commas, quoted where they hold commas, quotes or line ends, lines ended by CRLF or
 * LF. Tabs may stand for the commas. A UTF-8 byte order mark in front is skipped. Everything else is refused, with the
 * line and the column. */
#ifndef ESK_CSV_H
#define ESK_CSV_H

#include "complain.h"

#include <stddef.h>
#include <stdio.h>

#define ESK_CSV_MOST_COLUMNS 4096

typedef struct {
	const char *path;      /* for complaints */
	char *text;            /* of the whole file; fields point into it */
	char *next, *end;      /* what is left to read; a NUL stands at the end */
	unsigned line, column; /* of the field read last, from 1; a quoted line end stays in its line */
	unsigned lines;        /* that this line took so far */
	char separator;        /* a comma, unless the reader says otherwise before the first line */
} esk_csv;

/* Reads the file. Close it, which frees the fields too. */
esk_outcome esk_csv_open(const char *path, esk_csv *csv);
void esk_csv_close(esk_csv *csv);

/* One line's fields; *count is 0 for an empty line. */
esk_outcome esk_csv_read_line(esk_csv *csv, const char *fields[ESK_CSV_MOST_COLUMNS], size_t *count);

/* The text, quoted where it has to be; the comma or line end is the caller's. */
void esk_csv_write_field(const char *text, FILE *out);

#endif
