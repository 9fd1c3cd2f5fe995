#include "walk.h"

#include "eskel_dicom.h"

#include <errno.h>
#include <fts.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* A file that is called so claims to be a volume: one that is not is refused by the server, and not passed over. */
static const char *const suffixes[] = {
	".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".mgh", ".mgz", ".stl", ".ply", ".obj", ".dcm"};

bool esk_walk_is_folder(const char *path)
{
	struct stat status;
	return !stat(path, &status) && S_ISDIR(status.st_mode);
}

static bool is_called_a_volume(const char *name)
{
	const size_t size = strlen(name);
	for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++) {
		const size_t suffix = strlen(suffixes[i]);
		if (size > suffix && !strcasecmp(name + size - suffix, suffixes[i]))
			return true;
	}
	return false;
}

/* As the server decides it: by how the file begins, or by all of it where it is as short as that. */
static bool begins_as_a_volume(const char *path)
{
	char bytes[4096];
	eskel_intake *intake = NULL;
	eskel_volume *volume = NULL;
	FILE *file = fopen(path, "re");
	const size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
	eskel_status status = ESKEL_NOT_VOLUME;
	if (size > 0 && !eskel_intake_new(NULL, NULL, &intake))
		status = eskel_intake_feed(intake, bytes, size, NULL);
	if (!status && size < sizeof bytes)
		status = eskel_intake_finish(intake, &volume, NULL);
	eskel_volume_free(volume);
	eskel_intake_free(intake);
	if (file)
		fclose(file);
	return status != ESKEL_NOT_VOLUME;
}

/* Whether a link leads to a file below the folder, both without links. */
static bool stays_inside(const char *folder, const char *link)
{
	char target[PATH_MAX], top[PATH_MAX];
	struct stat status;
	if (!realpath(folder, top) || !realpath(link, target) || stat(target, &status) || !S_ISREG(status.st_mode))
		return false;
	const size_t size = strlen(top);
	return !strncmp(target, top, size) && (target[size] == '/' || top[size - 1] == '/');
}

static bool is_wanted(const char *folder, const FTSENT *entry)
{
	if (entry->fts_info == FTS_SL ? !stays_inside(folder, entry->fts_accpath) : entry->fts_info != FTS_F)
		return false;
	return is_called_a_volume(entry->fts_name) || begins_as_a_volume(entry->fts_accpath);
}

static esk_outcome take_entry(const char *folder, FTS *tree, FTSENT *entry, const char *query, esk_postings *postings)
{
	if (entry->fts_info == FTS_DNR || entry->fts_info == FTS_ERR || entry->fts_info == FTS_NS)
		return esk_complain(ESK_MISUSED, "%s: %s", entry->fts_path, strerror(entry->fts_errno));
	if (entry->fts_level > 0 && entry->fts_name[0] == '.') {
		fts_set(tree, entry, FTS_SKIP);
		return ESK_DONE;
	}
	if (!is_wanted(folder, entry))
		return ESK_DONE;
	return esk_postings_add(postings, strdup(entry->fts_path), strdup(query));
}

static int by_name(const FTSENT **a, const FTSENT **b)
{
	return strcmp((*a)->fts_name, (*b)->fts_name);
}

esk_outcome esk_walk_folder(const char *folder, const char *query, esk_postings *postings)
{
	char *const roots[] = {(char *)folder, NULL};
	FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_COMFOLLOW | FTS_NOCHDIR, by_name);
	esk_outcome outcome = ESK_DONE;
	FTSENT *entry = NULL;
	if (!tree)
		return esk_complain(ESK_MISUSED, "%s: %s", folder, strerror(errno));
	while (!outcome && (errno = 0, entry = fts_read(tree)))
		outcome = take_entry(folder, tree, entry, query, postings);
	if (!outcome && errno)
		outcome = esk_complain(ESK_MISUSED, "%s: %s", folder, strerror(errno));
	fts_close(tree);
	return outcome;
}
