#include "enroll_folders.h"

#include "bulk_summary.h"
#include "walk.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Posts, and says what became of it. */
static esk_outcome post_all(esk_session *session, const esk_postings *postings, const esk_manifest *verified)
{
	esk_bulk bulk = {.postings = postings, .verified = verified};
	const char *refused = esk_arguments_value(session->arguments, "refused");
	esk_outcome outcome = esk_bulk_post(session, &bulk);
	if (bulk.ended_by)
		esk_complain(outcome, "%s", bulk.ended_by);
	if (bulk.results)
		esk_bulk_summary_write(&bulk, esk_arguments_value(session->arguments, "json") ? stderr : stdout);
	if (bulk.results && refused)
		outcome = esk_outcome_worse(outcome, esk_bulk_summary_write_refused(&bulk, refused));
	esk_bulk_clear(&bulk);
	return outcome;
}

static esk_outcome add_by_manifest(esk_session *session, const char *folder, const char *path, esk_postings *postings)
{
	esk_manifest manifest = {0};
	esk_outcome outcome = esk_manifest_read(path, &manifest);
	if (!outcome)
		outcome = esk_manifest_postings(&manifest, folder, session, "", postings);
	esk_manifest_clear(&manifest);
	return outcome;
}

/* A folder by its own manifest, or else all volumes in it; or one file. */
static esk_outcome add_operand(esk_session *session, const char *operand, esk_postings *postings)
{
	char *path = NULL, *query = esk_session_query(session, "");
	esk_outcome outcome = query ? ESK_DONE : ESK_REFUSED;
	if (!outcome && asprintf(&path, "%s/manifest.csv", operand) < 0)
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	if (!outcome && !esk_walk_is_folder(operand))
		outcome = esk_postings_add(postings, strdup(operand), strdup(query));
	else if (!outcome && !access(path, F_OK) && esk_manifest_is_one(path))
		outcome = add_by_manifest(session, operand, path, postings);
	else if (!outcome)
		outcome = esk_walk_folder(operand, query, postings);
	free(query);
	free(path);
	return outcome;
}

static esk_outcome add_operands(esk_session *session, esk_postings *postings)
{
	const esk_arguments *arguments = session->arguments;
	const char *manifest = esk_arguments_value(arguments, "manifest");
	esk_outcome outcome = ESK_DONE;
	if (esk_arguments_value(arguments, "labels"))
		return esk_complain(ESK_MISUSED, "--labels is for single files, a folder takes --manifest");
	if (manifest && (arguments->operand_count != 1 || !esk_walk_is_folder(arguments->operands[0])))
		return esk_complain(ESK_MISUSED, "--manifest needs one folder, below which its paths are; %s",
			"see eskel enroll --help");
	if (manifest)
		return add_by_manifest(session, arguments->operands[0], manifest, postings);
	for (size_t i = 0; i < arguments->operand_count && !outcome; i++)
		outcome = add_operand(session, arguments->operands[i], postings);
	return outcome;
}

esk_outcome esk_enroll_folders(esk_session *session)
{
	esk_postings postings = {0};
	esk_outcome outcome = add_operands(session, &postings);
	if (!outcome && postings.count == 0)
		outcome = esk_complain(ESK_MISUSED, "%s: there is no volume in it", session->arguments->operands[0]);
	if (!outcome)
		outcome = post_all(session, &postings, NULL);
	esk_postings_clear(&postings);
	return outcome;
}

esk_outcome esk_enroll_exported(esk_session *session, const char *folder)
{
	char *path = NULL;
	esk_manifest manifest = {0};
	esk_postings postings = {0};
	esk_outcome outcome = ESK_DONE;
	if (asprintf(&path, "%s/shapes.csv", folder) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	outcome = esk_manifest_read(path, &manifest);
	if (!outcome)
		outcome = esk_manifest_postings(&manifest, folder, session, "&as_said=true", &postings);
	if (!outcome)
		outcome = post_all(session, &postings, &manifest);
	esk_postings_clear(&postings);
	esk_manifest_clear(&manifest);
	free(path);
	return outcome;
}
