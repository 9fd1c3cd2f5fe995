/* A table (csv.h) of files and what is said of them, a row a file, or a row a label of a file.
 *
 * The columns, in any order: path, below the table's folder; label; name, class, side, of the label or of all; subject,
 * age, sex, levels, weights (true, where voxels are weights) and attr.KEY, of all labels that are posted together. id, and
 * the other columns that an export writes, are not posted, but tell what an answer should say. Any other column is refused,
 * and so is a path that leads out of the folder, or one that is there twice with the same label. */
#ifndef ESK_MANIFEST_H
#define ESK_MANIFEST_H

#include "client.h"
#include "csv.h"
#include "postings.h"
#include "session.h"

typedef struct {
	const char *path;
	int32_t label; /* 0: all */
	unsigned line;
	const char **cells; /* [column_count], "" where nothing is said */
	char *shared;       /* the query of what is said of all labels that are posted together */
} esk_manifest_row;

typedef struct {
	esk_csv csv; /* holds the text */
	const char **columns;
	size_t column_count, count;
	esk_manifest_row *rows;
} esk_manifest;

/* Whether the table has a column called path: not every manifest.csv in a folder is one for us. */
bool esk_manifest_is_one(const char *path);

esk_outcome esk_manifest_read(const char *path, esk_manifest *manifest);
void esk_manifest_clear(esk_manifest *manifest);

/* Adds the files of the folder that the manifest names, in its order; neighbouring rows of a file that say the same of all
 * labels are posted together. Query parameters among the arguments are said of all files; one for which there is a column is
 * refused. in_front goes before every query. */
esk_outcome esk_manifest_postings(const esk_manifest *manifest, const char *folder, const esk_session *session,
	const char *in_front, esk_postings *postings);

/* In which column an answer differs from the rows of its posting, in one sentence: free() it. NULL for none, or when memory
 * ran out. Columns that tell of a server (created) or of a file (path, warnings) are not compared. */
char *esk_manifest_compare(const esk_manifest *manifest, const esk_posting *posting, const esk_answer *answer);

#endif
