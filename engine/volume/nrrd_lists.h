/* Lists in the fields of an NRRD header: numbers, words and vectors, one for each axis. */
#ifndef ESK_NRRD_LISTS_H
#define ESK_NRRD_LISTS_H

#include "nrrd_lines.h"

#define ESK_NRRD_AXES_MOST 4

typedef struct {
	const esk_nrrd_fields *fields;
	int count;
	int in_space[3]; /* the axes that are, ascending */
} esk_nrrd_axes;

/* These move *at past what they read and the blanks behind it. */
bool esk_nrrd_read_number(const char **at, double *number);
/* What blanks separate; a "quoted one" is a word, without its quotes. */
bool esk_nrrd_read_word(const char **at, esk_nrrd_span *word);
/* (x,y,z), or none, which leaves vector. */
bool esk_nrrd_read_vector(const char **at, double vector[3], bool *none);

/* A number for each axis and nothing else. */
eskel_status esk_nrrd_read_numbers(const esk_nrrd_axes *axes, esk_nrrd_field field, const char *name,
	double numbers[ESK_NRRD_AXES_MOST], eskel_error *error);
/* ESKEL_MALFORMED: the field, expected count of what. */
eskel_status esk_nrrd_refuse_list(const esk_nrrd_axes *axes, esk_nrrd_field field, const char *name, const char *what,
	int count, eskel_error *error);

#endif
