#include "options.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const struct {
	esk_command command;
	const char *first, *second; /* its words; NULL: none */
	const char *argument, *usage, *help;
} commands[] = {
	{ESK_SERVE, NULL, NULL, NULL, "eskeld", "serve the database until SIGTERM"},
	{ESK_TOKEN_ADD, "token", "add", "a NAME", "eskeld token add NAME", "make a bearer token and print it, once"},
	{ESK_TOKEN_LIST, "token", "list", NULL, "eskeld token list", "list the tokens"},
	{ESK_TOKEN_REVOKE, "token", "revoke", "a NUMBER", "eskeld token revoke NUMBER",
		"make a token worthless at once"},
	{ESK_AUDIT_VERIFY, "audit", "verify", NULL, "eskeld audit verify", "check the hash chain of all changes"},
};

enum kind { TEXT, LIST, NUMBER };

#define AT(member) offsetof(esk_options, member)
#define KIB ((uint64_t)1 << 10)
#define GIB ((uint64_t)1 << 30)

static const struct row {
	const char *name;
	unsigned commands; /* that take it */
	enum kind kind;
	size_t offset;
	const char *value;
	uint64_t initial, least, most; /* of a NUMBER */
	const char *help;
} rows[] = {
	{"database", ~0u, TEXT, AT(database), "FILE", 0, 0, 0, "the database, made if it is not there"},
	{"listen", ESK_SERVE, TEXT, AT(listen), "ADDRESS:PORT", 0, 0, 0,
		"default 127.0.0.1:8467; [::1]:8467; port 0 takes a free one. Other than loopback needs a token"},
	{"host", ESK_SERVE, LIST, AT(hosts), "NAME", 0, 0, 0,
		"a name or address that clients use for this server, beside localhost and that of --listen"},
	{"tls-certificate", ESK_SERVE, TEXT, AT(tls_certificate), "FILE", 0, 0, 0, "serve https with this PEM chain"},
	{"tls-key", ESK_SERVE, TEXT, AT(tls_key), "FILE", 0, 0, 0, "and this PEM key"},
	{"threads", ESK_SERVE, NUMBER, AT(threads), "N", 2, 2, 64, "for the network"},
	{"workers", ESK_SERVE, NUMBER, AT(workers), "N", 0, 0, 256, "threads that compute; 0: two a processor"},
	{"queue", ESK_SERVE, NUMBER, AT(queue), "N", 256, 1, 65536,
		"uploads and computations under way or waiting; past it clients get 503"},
	{"connections", ESK_SERVE, NUMBER, AT(connections), "N", 4096, 16, 65536, "open at a time"},
	{"rate", ESK_SERVE, NUMBER, AT(rate), "N", 5000, 1, 1000000,
		"requests a second of one token, or of one address without a token; past it clients get 429"},
	{"drain", ESK_SERVE, NUMBER, AT(drain), "SECONDS", 30, 0, 3600, "for requests under way when asked to stop"},
	{"most-body", ESK_SERVE, NUMBER, AT(most_body), "BYTES", GIB, KIB, 1024 * GIB, "in one request"},
	{"most-voxels", ESK_SERVE, NUMBER, AT(most_voxels), "N", 2 * GIB, 1, 1024 * GIB, "in the grid of a volume"},
	{"most-runs", ESK_SERVE, NUMBER, AT(most_runs), "N", 16 * KIB *KIB, 1, GIB,
		"rows of voxels in all labels of a volume; each takes up to 150 bytes of memory"},
	{"most-labels", ESK_SERVE, NUMBER, AT(most_labels), "N", 1024, 1, 65535, "in one request"},
	{"most-distances", ESK_SERVE, NUMBER, AT(most_distances), "N", 4000000, 1, GIB,
		"in a picture of a matrix; other formats have no limit"},
	{"most-known", ESK_SERVE, NUMBER, AT(most_known), "BYTES", 2 * GIB, 1024 * KIB, 1024 * GIB,
		"of memory for shapes that recognitions have met, 24 kB each"},
	{"most-results", ESK_SERVE, NUMBER, AT(most_results), "BYTES", 16 * GIB, 1024 * KIB, 1024 * 1024 * GIB,
		"of disk, in DATABASE-jobs, for the results of jobs; the oldest make room"},
	{"most-meshes", ESK_SERVE, NUMBER, AT(most_meshes), "BYTES", GIB, 1024 * KIB, 1024 * 1024 * GIB,
		"of disk, in DATABASE-meshes, for meshes that were asked for; those not used for longest make room"},
	{"role", ESK_TOKEN_ADD, TEXT, AT(role), "ROLE", 0, 0, 0, "read, write or admin; default read"},
	{"days", ESK_TOKEN_ADD, NUMBER, AT(days), "N", 0, 0, 36500, "until the token expires; 0: never"},
};

enum { COMMANDS = sizeof commands / sizeof *commands, ROWS = sizeof rows / sizeof *rows };

/* ---- help */

enum { INDENT = 26, WIDTH = 100 };

/* Prints words after a head of INDENT columns, none of them past WIDTH. */
static void print_wrapped(const char *words)
{
	int column = INDENT;
	while (*words) {
		int size = (int)strcspn(words, " ");
		if (column + 1 + size > WIDTH) {
			printf("\n%*s", INDENT, "");
			column = INDENT;
		}
		printf(" %.*s", size, words);
		column += 1 + size;
		words += size;
		words += *words == ' ';
	}
	printf("\n");
}

/* 1G rather than 1073741824. */
static const char *short_number(uint64_t n, char text[24])
{
	bool whole = n >= GIB && n % GIB == 0;
	snprintf(text, 24, "%" PRIu64 "%s", whole ? n / GIB : n, whole ? "G" : "");
	return text;
}

static void print_row(const struct row *row)
{
	char head[64], words[256], initial[24], least[24], most[24];
	snprintf(head, sizeof head, "--%s %s", row->name, row->value);
	if (row->kind == NUMBER)
		snprintf(words, sizeof words, "%s (%s; %s to %s)", row->help, short_number(row->initial, initial),
			short_number(row->least, least), short_number(row->most, most));
	else if (row->kind == LIST)
		snprintf(words, sizeof words, "%s (up to %d times)", row->help, ESK_MOST_HOSTS);
	else
		snprintf(words, sizeof words, "%s", row->help);
	printf("  %-*s", INDENT - 2, head);
	print_wrapped(words);
}

static void print_help(void)
{
	printf("eskeld, the shape recognition database server\n\n");
	for (int c = 0; c < COMMANDS; c++)
		printf("%-*s %s\n", INDENT, commands[c].usage, commands[c].help);
	static const struct {
		unsigned command;
		const char *title;
	} sections[] = {{~0u, "Always needed"}, {ESK_SERVE, "To serve"}, {ESK_TOKEN_ADD, "token add"}};
	for (size_t s = 0; s < sizeof sections / sizeof *sections; s++) {
		printf("\n%s:\n", sections[s].title);
		for (int r = 0; r < ROWS; r++)
			if (rows[r].commands == sections[s].command)
				print_row(&rows[r]);
	}
	printf("\nNumbers may end in K, M or G, for powers of 1024.\n"
	       "While a database has no token, whoever reaches a loopback address may do everything; from its first\n"
	       "token on, each request needs one (Authorization: Bearer ...). Token commands work beside a running\n"
	       "server, and at once.\n");
}

/* ---- parsing */

static esk_options_result wrong(const char *format, ...) __attribute__((format(printf, 1, 2)));

static esk_options_result wrong(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	fprintf(stderr, "eskeld: ");
	vfprintf(stderr, format, arguments);
	fprintf(stderr, "; see eskeld --help\n");
	va_end(arguments);
	return ESK_OPTIONS_WRONG;
}

/* Digits and at most one of K, M, G. */
static bool number(const char *text, uint64_t *out)
{
	uint64_t value = 0;
	const char *c = text;
	for (; *c >= '0' && *c <= '9'; c++)
		if (__builtin_mul_overflow(value, 10, &value) || __builtin_add_overflow(value, *c - '0', &value))
			return false;
	if (c == text)
		return false;
	int shift = *c == 'K' ? 10 : *c == 'M' ? 20 : *c == 'G' ? 30 : 0;
	if (value > UINT64_MAX >> shift || c[shift ? 1 : 0])
		return false;
	*out = value << shift;
	return true;
}

static esk_options_result store(const struct row *row, const char *value, esk_options *options)
{
	char *member = (char *)options + row->offset;
	uint64_t n;
	switch (row->kind) {
	case TEXT:
		*(const char **)(void *)member = value;
		return ESK_OPTIONS_RUN;
	case LIST:
		if (options->host_count == ESK_MOST_HOSTS)
			return wrong("--%s is given more than %d times", row->name, ESK_MOST_HOSTS);
		options->hosts[options->host_count++] = value;
		return ESK_OPTIONS_RUN;
	case NUMBER:
		if (!number(value, &n) || n < row->least || n > row->most)
			return wrong("--%s is %s, expected a number from %" PRIu64 " to %" PRIu64, row->name, value,
				row->least, row->most);
		*(uint64_t *)(void *)member = n;
		return ESK_OPTIONS_RUN;
	}
	return ESK_OPTIONS_WRONG;
}

/* argv[*i] is --name=value, or --name with the value in the next argument. */
static esk_options_result take_option(int argc, char **argv, int *i, esk_options *options)
{
	const char *name = argv[*i] + 2, *equals = strchr(name, '=');
	size_t size = equals ? (size_t)(equals - name) : strlen(name);
	const struct row *row = NULL;
	for (int r = 0; r < ROWS && !row; r++)
		if (strlen(rows[r].name) == size && !memcmp(rows[r].name, name, size))
			row = &rows[r];
	if (!row)
		return wrong("there is no option %s", argv[*i]);
	if (!(row->commands & options->command))
		return wrong("--%s is not for this command", row->name);
	if (!equals && ++*i == argc)
		return wrong("--%s needs a value", row->name);
	const char *value = equals ? equals + 1 : argv[*i];
	if (!*value)
		return wrong("--%s is empty", row->name);
	return store(row, value, options);
}

/* Reads the command's words and argument; returns the index of what follows, 0 when there is no such command. */
static int take_command(int argc, char **argv, esk_options *options)
{
	if (argc < 2 || argv[1][0] == '-') {
		options->command = ESK_SERVE;
		return 1;
	}
	for (int c = 0; c < COMMANDS && argc > 2; c++) {
		if (!commands[c].first || strcmp(argv[1], commands[c].first) != 0 ||
			strcmp(argv[2], commands[c].second) != 0)
			continue;
		options->command = commands[c].command;
		return 3;
	}
	return 0;
}

/* What the command's argument is, NULL when it takes none. */
static const char *argument_of(esk_command command)
{
	for (int c = 0; c < COMMANDS; c++)
		if (commands[c].command == command)
			return commands[c].argument;
	return NULL;
}

static esk_options_result check_whole(const esk_options *options)
{
	if (!options->database)
		return wrong("--database is missing");
	if (argument_of(options->command) && !options->argument)
		return wrong("the command needs %s", argument_of(options->command));
	if (!options->tls_certificate != !options->tls_key)
		return wrong("--tls-certificate and --tls-key belong together");
	return ESK_OPTIONS_RUN;
}

esk_options_result esk_options_parse(int argc, char **argv, esk_options *options)
{
	for (int i = 1; i < argc; i++) {
		if (!strcmp(argv[i], "--help")) {
			print_help();
			return ESK_OPTIONS_DONE;
		}
		if (!strcmp(argv[i], "--version")) {
			printf("eskeld %s\n", ESKEL_VERSION);
			return ESK_OPTIONS_DONE;
		}
	}
	esk_options out = {.listen = "127.0.0.1:8467", .role = "read"};
	for (int r = 0; r < ROWS; r++)
		if (rows[r].kind == NUMBER)
			*(uint64_t *)(void *)((char *)&out + rows[r].offset) = rows[r].initial;
	int next = take_command(argc, argv, &out);
	if (!next)
		return wrong("there is no command %s%s%s", argv[1], argc > 2 ? " " : "", argc > 2 ? argv[2] : "");
	for (int i = next; i < argc; i++) {
		if (!strncmp(argv[i], "--", 2)) {
			if (take_option(argc, argv, &i, &out) != ESK_OPTIONS_RUN)
				return ESK_OPTIONS_WRONG;
		} else if (!out.argument && argument_of(out.command)) {
			out.argument = argv[i];
		} else {
			return wrong("%s is one word too many", argv[i]);
		}
	}
	if (check_whole(&out) != ESK_OPTIONS_RUN)
		return ESK_OPTIONS_WRONG;
	*options = out;
	return ESK_OPTIONS_RUN;
}
