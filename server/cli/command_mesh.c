/* eskel mesh: the surface of a stored shape, into a file. Its name says the format, unless an option does. */
#include "command.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* "&format=stl" for "talus.STL"; "" for a name that says nothing, or beside --format. */
static const char *format_of(const esk_arguments *arguments)
{
	static const char *const queries[] = {"&format=glb", "&format=stl", "&format=ply", "&format=obj"};
	const char *output = esk_arguments_value(arguments, "output");
	const char *ending = output ? strrchr(output, '.') : NULL;
	if (!ending || esk_arguments_value(arguments, "format"))
		return "";
	for (size_t i = 0; i < sizeof queries / sizeof *queries; i++)
		if (!strcasecmp(ending + 1, queries[i] + strlen("&format=")))
			return queries[i];
	return "";
}

esk_outcome esk_command_mesh(esk_session *session)
{
	const esk_arguments *arguments = session->arguments;
	const char *id = arguments->operands[0];
	char *path = NULL;
	esk_outcome outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	char *shape = esk_session_path("/shapes/", id), *query = esk_session_query(session, format_of(arguments));
	if (shape && query && asprintf(&path, "%s/mesh", shape) >= 0) {
		const esk_request request = {.path = path, .query = query};
		outcome = esk_session_download(session, &request, id, esk_arguments_value(arguments, "output"));
		free(path);
	} else {
		outcome = ESK_REFUSED;
	}
	free(query);
	free(shape);
	return outcome;
}
