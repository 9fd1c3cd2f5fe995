/* The command line of eskeld: what it may say, in one table (options.c) that yields parsing, range checks, defaults
 * and --help. */
#ifndef ESK_OPTIONS_H
#define ESK_OPTIONS_H

#include <stddef.h>
#include <stdint.h>

typedef enum {
	ESK_SERVE = 1,
	ESK_TOKEN_ADD = 2,
	ESK_TOKEN_LIST = 4,
	ESK_TOKEN_REVOKE = 8,
	ESK_AUDIT_VERIFY = 16,
} esk_command;

#define ESK_MOST_HOSTS 16

typedef struct {
	esk_command command;
	const char *argument; /* of token add (a name) and token revoke (a number) */
	const char *database, *listen, *tls_certificate, *tls_key, *role;
	const char *hosts[ESK_MOST_HOSTS];
	size_t host_count;
	uint64_t threads, workers, queue, connections, rate, drain, days;
	uint64_t most_body, most_voxels, most_runs, most_labels, most_distances, most_known, most_results, most_meshes;
} esk_options;

typedef enum { ESK_OPTIONS_RUN, ESK_OPTIONS_DONE, ESK_OPTIONS_WRONG } esk_options_result;

/* DONE: --help or --version was printed. WRONG: a sentence went to standard error. The texts are those of argv. */
esk_options_result esk_options_parse(int argc, char **argv, esk_options *options);

#endif
