/* The command line of eskel: its commands and options, in two tables (arguments.c) that yield parsing, --help and the
 * query parameters of a request. */
#ifndef ESK_ARGUMENTS_H
#define ESK_ARGUMENTS_H

#include "complain.h"

#include <stddef.h>
#include <stdio.h>

typedef struct esk_session esk_session;

typedef struct {
	const char *name, *operands, *summary;
	size_t fewest_operands, most_operands;
	int bit; /* of this command in an option's set */
	esk_outcome (*run)(esk_session *session);
} esk_command;

typedef struct esk_option esk_option;

typedef struct {
	const esk_option *option;
	const char *value; /* "" for a flag */
} esk_given_option;

/* All texts are those of argv. */
typedef struct {
	const esk_command *command;
	size_t given_count, operand_count;
	esk_given_option *given; /* in the order given */
	const char **operands;
} esk_arguments;

/* argv[1] is the command. ESK_MISUSED, with a complaint, for what the tables do not allow. Cleared by
 * esk_arguments_clear either way. */
esk_outcome esk_arguments_parse(int argc, char **argv, esk_arguments *arguments);
void esk_arguments_clear(esk_arguments *arguments);

/* The value last given to an option, "" for a flag; NULL when it was not given. */
const char *esk_arguments_value(const esk_arguments *arguments, const char *option);

/* The next value given to an option that may be repeated; *position starts at 0. NULL after the last. */
const char *esk_arguments_next(const esk_arguments *arguments, const char *option, size_t *position);

/* Writes "&name=value" for every given option that is a query parameter, but not for the option except (NULL: none). */
void esk_arguments_write_query(const esk_arguments *arguments, const char *except, FILE *out);

/* Percent-encodes all but the unreserved characters of RFC 3986. */
void esk_arguments_write_escaped(const char *value, FILE *out);

/* The help of a command, or of the whole program for NULL. */
void esk_arguments_write_help(const esk_command *command, FILE *out);

#endif
