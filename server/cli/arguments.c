#include "arguments.h"

#include "command.h"

#include <stdlib.h>
#include <string.h>

enum {
	ENROLL = 1,
	RECOGNIZE = 2,
	DISTANCES = 4,
	SHOW = 8,
	SKELETON = 16,
	EVALUATE = 32,
	CHECK = 64,
	EXPORT = 128,
	IMPORT = 256,
	JOBS = 512,
	JOB = 1024,
	MESH = 2048,
	RECONSTRUCT = 4096
};
enum {
	ALL = ENROLL | RECOGNIZE | DISTANCES | SHOW | SKELETON | EVALUATE | CHECK | EXPORT | IMPORT | JOBS | JOB |
	      MESH | RECONSTRUCT,
	SERVED = ALL & ~SKELETON,
	FILTERED = SERVED & ~(ENROLL | IMPORT | JOBS | JOB | MESH | RECONSTRUCT),
	COMPARED = RECOGNIZE | CHECK | DISTANCES | EVALUATE
};

static const esk_command commands[] = {
	{"enroll", "FILE|DIR...", "store the labelled objects of volumes", 1, SIZE_MAX, ENROLL, esk_command_enroll},
	{"recognize", "FILE|ID...", "say what objects are, and on which side", 1, SIZE_MAX, RECOGNIZE,
		esk_command_recognize},
	{"check", "FILE...", "look for wrong labels and bad segmentations in label maps", 1, SIZE_MAX, CHECK,
		esk_command_check},
	{"distances", "[ID...]", "the distance of every pair of shapes", 0, SIZE_MAX, DISTANCES, esk_command_distances},
	{"evaluate", "", "how well distances find classes and sides among stored shapes", 0, 0, EVALUATE,
		esk_command_evaluate},
	{"show", "[ID]", "list shapes, or show one", 0, 1, SHOW, esk_command_show},
	{"export", "DIR", "write the library: tables, and a volume a shape", 1, 1, EXPORT, esk_command_export},
	{"import", "DIR", "store what an export wrote", 1, 1, IMPORT, esk_command_import},
	{"mesh", "ID", "the surface of a stored shape as triangles", 1, 1, MESH, esk_command_mesh},
	{"reconstruct", "ID", "fit a surface to a stored shape", 1, 1, RECONSTRUCT, esk_command_reconstruct},
	{"jobs", "", "list jobs: answers that nobody waits for", 0, 0, JOBS, esk_command_jobs},
	{"job", "ID", "wait for a job to end; interrupted, it leaves it alone", 1, 1, JOB, esk_command_job},
	{"skeleton", "FILE", "the skeletons of a volume's objects, without a server", 1, 1, SKELETON,
		esk_command_skeleton},
};

struct esk_option {
	const char *name;
	const char *value; /* what it takes, for the help; NULL for a flag */
	int commands;      /* that take it */
	const char *query; /* parameter for the value, or a whole "parameter=value" for a flag; "parameter." for a
			      KEY=VALUE that becomes parameter.KEY=VALUE; NULL: not for the server */
	const char *help;
};

static const esk_option options[] = {
	{"labels", "TABLE", ENROLL | RECOGNIZE | CHECK, NULL,
		"names for the labels: CSV (label, name, class, side), BIDS, ITK-SNAP, FreeSurfer or 3D Slicer"},
	{"label", "N", ENROLL | RECOGNIZE | SKELETON | CHECK, "label",
		"this label of the volume only; may be repeated"},
	{"weights", NULL, ENROLL | RECOGNIZE | SKELETON | CHECK, "weights=true",
		"voxels say how much of one object they hold: probabilities, partial volumes"},
	{"spacing", "MM", ENROLL | RECOGNIZE | SKELETON | CHECK, "spacing",
		"for a mesh: the size of its voxels, 0.001 to 1000 (default: about 100,000 voxels)"},
	{"name", "NAME", ENROLL | RECOGNIZE | CHECK, "name", "what it is called"},
	{"class", "CLASS", ENROLL, "class", "what kind of thing it is, such as femur"},
	{"side", "SIDE", ENROLL, "side", "left, right or none"},
	{"subject", "SUBJECT", ENROLL, "subject", "whose it is"},
	{"age", "YEARS", ENROLL, "age", "the subject's age"},
	{"sex", "SEX", ENROLL, "sex", "the subject's sex: female or male"},
	{"attr", "KEY=VALUE", ENROLL, "attr.", "anything else; may be repeated"},
	{"levels", "K", ENROLL | SKELETON, "levels", "depth of the skeleton, 1 to 64 (16)"},

	{"manifest", "TABLE", ENROLL, NULL,
		"the files of DIR: CSV with the columns path, label, name, class, side, subject, age, sex, levels, "
		"weights, attr.KEY (DIR/manifest.csv, or else all)"},
	{"parallel", "N", ENROLL | IMPORT, NULL, "files under way at once, 1 to 64 (4); 1 keeps their order in lists"},
	{"refused", "FILE", ENROLL | IMPORT, NULL, "also write what was refused: CSV with the columns path, reason"},
	{"format", "FORMAT", EXPORT, NULL, "of the volumes: nifti (default) or nrrd"},

	{"limit", "N", RECOGNIZE, "limit", "neighbours (5)"},
	{"mode", "MODE", RECOGNIZE | CHECK, "mode", "exact (default) or pruned"},
	{"keep", "SHARE", RECOGNIZE, "keep", "for --mode pruned: what each level keeps (0.1)"},
	{"minimum", "N", RECOGNIZE, "minimum", "for --mode pruned: the fewest that a level keeps (10)"},
	{"scale", "KIND", RECOGNIZE, "scale",
		"none (default), or neighbourhood: distances mean more where shapes are dense"},
	{"order", "KIND", RECOGNIZE, "order",
		"distance (default), or position: of the nearest, those whose parts lie alike come first"},
	{"explain", NULL, RECOGNIZE, "explain=true", "with matched classes and what differs"},
	{"signature", "KIND", COMPARED, "signature", "log (default) or paper"},
	{"distance", "KIND", COMPARED, "distance", "sum over the levels (default) or one level"},
	{"level", "K", COMPARED, "level", "for --distance level and --explain (10)"},
	{"metric", "KIND", COMPARED, "metric", "manhattan (default), euclidean or root"},
	{"size", "KIND", COMPARED, "size", "fixed (default), or free: size does not count"},
	{"format", "FORMAT", DISTANCES, "format",
		"json, csv, npy (for numpy.load) or svg (a picture), in place of a table"},
	{"plot", "KIND", DISTANCES, "plot", "of --format svg: heatmap (default) or map"},
	{"output", "FILE", DISTANCES, NULL, "where the matrix goes; default: standard output"},
	{"level", "K", MESH | RECONSTRUCT, "level", "of the skeleton; default: the deepest"},
	{"step", "MM", MESH, "step", "edge of the cells that the surface is followed through"},
	{"distance", "MM", MESH, "distance", "between the eye and the shape, which chooses level and step"},
	{"primitive", "KIND", MESH, "primitive",
		"ellipsoid (default), or superquadric, deformed or algebraic as reconstruct has fitted them"},
	{"primitive", "KIND", RECONSTRUCT, "primitive", "deformed (default), superquadric or algebraic"},
	{"method", "NAME", RECONSTRUCT, "method", "joint (default), tabu or hopping; of algebraic ones least_squares"},
	{"seed", "N", RECONSTRUCT, "seed", "of tabu and hopping, which try at random (0)"},
	{"compose", "KIND", MESH, "compose", "blend (default) or union of the ellipsoids"},
	{"format", "FORMAT", MESH, "format", "glb, stl, ply or obj; default: what the output's name says, or else glb"},
	{"frame", "AXES", MESH, "frame", "ras (right, front, head; default) or lps (left, back, head)"},
	{"source", "KIND", MESH, "source", "skeleton (default), or voxels: their own surface"},
	{"output", "FILE", MESH, NULL, "where the mesh goes; default: standard output"},
	{"job", NULL, DISTANCES, NULL, "as a job, which eskel job waits for"},
	{"output", "FILE", JOB, NULL, "where the result goes; default: nowhere, only what became of the job is shown"},
	{"cancel", NULL, JOB, NULL, "end the job, or forget one that has ended, in place of waiting"},
	{"columns", NULL, DISTANCES, "columns=all", "compare with all shapes, in place of among themselves"},
	{"columns-id", "ID,...", DISTANCES, "columns.id", "compare with these shapes"},
	{"columns-class", "CLASS", DISTANCES, "columns.class", "compare with shapes of this class"},
	{"columns-side", "SIDE", DISTANCES, "columns.side", "of this side: left, right or none"},
	{"columns-subject", "SUBJECT", DISTANCES, "columns.subject", "of this subject"},
	{"columns-sex", "SEX", DISTANCES, "columns.sex", "of this sex: female or male"},
	{"columns-age-min", "YEARS", DISTANCES, "columns.age_min", "from this age"},
	{"columns-age-max", "YEARS", DISTANCES, "columns.age_max", "to this age"},
	{"columns-attr", "KEY=VALUE", DISTANCES, "columns.attr.", "with this attribute; may be repeated"},
	{"columns-text", "TEXT", DISTANCES, "columns.q", "with this text in name, class or subject"},
	{"leave-out", "WHAT", EVALUATE, "leave_out",
		"what a shape is not compared with: itself (shape, default) or its subject"},
	{"all", NULL, EVALUATE, NULL, "every distance, but for what is given; a row each"},
	{"csv", NULL, EVALUATE, NULL, "the rows as CSV"},
	{"html", "FILE", EVALUATE, NULL, "also a page with plots, into this file"},

	{"class", "CLASS", FILTERED, "class", "only shapes of this class"},
	{"side", "SIDE", FILTERED, "side", "only of this side: left, right or none"},
	{"subject", "SUBJECT", FILTERED, "subject", "only of this subject"},
	{"not-subject", "SUBJECT", RECOGNIZE | CHECK, "not.subject", "only of other subjects"},
	{"sex", "SEX", FILTERED, "sex", "only of this sex: female or male"},
	{"age-min", "YEARS", FILTERED, "age_min", "only from this age"},
	{"age-max", "YEARS", FILTERED, "age_max", "only to this age"},
	{"attr", "KEY=VALUE", FILTERED, "attr.", "only with this attribute; may be repeated"},
	{"text", "TEXT", FILTERED, "q", "only with this text in name, class or subject"},
	{"limit", "N", SHOW, "limit", "shapes in one list"},
	{"cursor", "CURSOR", SHOW, "cursor", "go on where an earlier list ended"},

	{"server", "URL", SERVED, NULL, "default: $ESKEL_SERVER, or else " ESK_DEFAULT_SERVER},
	{"token-file", "FILE", SERVED, NULL, "holds the bearer token; default: $ESKEL_TOKEN_FILE, or else none"},
	{"json", NULL, ALL, NULL, "the answers as they came"},
	{"quiet", NULL, ALL, NULL, "no progress"},
	{"help", NULL, ALL, NULL, "this help"},
};

enum { COMMAND_COUNT = sizeof commands / sizeof *commands, OPTION_COUNT = sizeof options / sizeof *options };

/* ---- help */

static void write_command_help(const esk_command *command, FILE *out)
{
	fprintf(out, "usage: eskel %s%s%s [options]\n\n%s\n\n", command->name, *command->operands ? " " : "",
		command->operands, command->summary);
	for (size_t i = 0; i < OPTION_COUNT; i++) {
		if (!(options[i].commands & command->bit))
			continue;
		int width = fprintf(out, "  --%s %s", options[i].name, options[i].value ? options[i].value : "");
		fprintf(out, "%*s%s\n", width < 26 ? 26 - width : 1, "", options[i].help);
	}
}

void esk_arguments_write_help(const esk_command *command, FILE *out)
{
	if (command) {
		write_command_help(command, out);
		return;
	}
	fputs("usage: eskel COMMAND ... [options]\n\nA client of eskeld, the shape recognition database server.\n\n",
		out);
	for (size_t i = 0; i < COMMAND_COUNT; i++)
		fprintf(out, "  %-10s %-12s%s\n", commands[i].name, commands[i].operands, commands[i].summary);
	fputs("\n  eskel COMMAND --help lists its options; eskel --version\n\n"
	      "Exit code: 0 done, 1 refused or not recognised, 2 wrong usage, 3 the server cannot be reached.\n"
	      "Of check: 0 nothing found, 1 findings, 2 refused or wrong usage, 3 the server cannot be reached.\n",
		out);
}

/* ---- parsing */

static const esk_command *find_command(const char *name)
{
	for (size_t i = 0; i < COMMAND_COUNT; i++) {
		if (!strcmp(commands[i].name, name))
			return &commands[i];
	}
	return NULL;
}

static const esk_option *find_option(const esk_command *command, const char *name, size_t length)
{
	for (size_t i = 0; i < OPTION_COUNT; i++) {
		if (options[i].commands & command->bit && strlen(options[i].name) == length &&
			!strncmp(options[i].name, name, length))
			return &options[i];
	}
	return NULL;
}

static bool takes_key(const esk_option *option)
{
	return option->query && option->query[strlen(option->query) - 1] == '.';
}

/* --name VALUE, --name=VALUE or a flag; *next is the argument after it. */
static esk_outcome parse_option(esk_arguments *arguments, const char *argument, char ***next)
{
	const char *name = argument + 2, *equals = strchr(name, '=');
	const esk_command *command = arguments->command;
	const esk_option *option = find_option(command, name, equals ? (size_t)(equals - name) : strlen(name));
	const char *value = equals ? equals + 1 : "";
	if (!option)
		return esk_complain(ESK_MISUSED, "%s is not an option of %s: see eskel %s --help", argument,
			command->name, command->name);
	if (!option->value && equals)
		return esk_complain(ESK_MISUSED, "--%s takes no value", option->name);
	if (option->value && !equals) {
		if (!**next)
			return esk_complain(ESK_MISUSED, "--%s needs a value: %s", option->name, option->value);
		value = *(*next)++;
	}
	if (takes_key(option) && !strchr(value, '='))
		return esk_complain(ESK_MISUSED, "--%s needs %s, not %s", option->name, option->value, value);
	arguments->given[arguments->given_count++] = (esk_given_option){option, value};
	return ESK_DONE;
}

static esk_outcome parse_all(esk_arguments *arguments, char **next)
{
	bool options_ended = false;
	while (*next) {
		const char *argument = *next++;
		if (options_ended || strncmp(argument, "--", 2)) {
			arguments->operands[arguments->operand_count++] = argument;
		} else if (!argument[2]) {
			options_ended = true;
		} else {
			esk_outcome outcome = parse_option(arguments, argument, &next);
			if (outcome)
				return outcome;
		}
	}
	return ESK_DONE;
}

static esk_outcome check_operands(const esk_arguments *arguments)
{
	const esk_command *command = arguments->command;
	size_t count = arguments->operand_count;
	if (esk_arguments_value(arguments, "help") ||
		(count >= command->fewest_operands && count <= command->most_operands))
		return ESK_DONE;
	return esk_complain(ESK_MISUSED, "eskel %s takes %s, %zu given", command->name,
		*command->operands ? command->operands : "no operand", count);
}

esk_outcome esk_arguments_parse(int argc, char **argv, esk_arguments *arguments)
{
	*arguments = (esk_arguments){.command = find_command(argv[1])};
	if (!arguments->command)
		return esk_complain(ESK_MISUSED, "%s is not a command: see eskel --help", argv[1]);
	arguments->given = calloc((size_t)argc, sizeof *arguments->given);
	arguments->operands = calloc((size_t)argc, sizeof *arguments->operands);
	if (!arguments->given || !arguments->operands)
		return esk_complain(ESK_REFUSED, "memory ran out");
	esk_outcome outcome = parse_all(arguments, argv + 2);
	return outcome ? outcome : check_operands(arguments);
}

void esk_arguments_clear(esk_arguments *arguments)
{
	free(arguments->given);
	free(arguments->operands);
	*arguments = (esk_arguments){0};
}

/* ---- values */

const char *esk_arguments_value(const esk_arguments *arguments, const char *option)
{
	const char *last = NULL, *value;
	size_t position = 0;
	while ((value = esk_arguments_next(arguments, option, &position)))
		last = value;
	return last;
}

const char *esk_arguments_next(const esk_arguments *arguments, const char *option, size_t *position)
{
	while (*position < arguments->given_count) {
		const esk_given_option *given = &arguments->given[(*position)++];
		if (!strcmp(given->option->name, option))
			return given->value;
	}
	return NULL;
}

static void write_escaped(const char *value, size_t length, FILE *out)
{
	for (size_t i = 0; i < length; i++) {
		unsigned char c = (unsigned char)value[i];
		bool unreserved = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
				  (c && strchr("-._~", c));
		fprintf(out, unreserved ? "%c" : "%%%02X", c);
	}
}

void esk_arguments_write_escaped(const char *value, FILE *out)
{
	write_escaped(value, strlen(value), out);
}

void esk_arguments_write_query(const esk_arguments *arguments, const char *except, FILE *out)
{
	for (size_t i = 0; i < arguments->given_count; i++) {
		const esk_option *option = arguments->given[i].option;
		const char *value = arguments->given[i].value;
		if (!option->query || (except && !strcmp(option->name, except)))
			continue;
		fprintf(out, "&%s", option->query);
		if (takes_key(option)) {
			size_t key = strcspn(value, "=");
			write_escaped(value, key, out);
			value += key + 1;
		}
		if (option->value) {
			fputc('=', out);
			esk_arguments_write_escaped(value, out);
		}
	}
}
