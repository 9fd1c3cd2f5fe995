/* eskel store: shapes, their skeletons and who did what, in one SQLite file.
 *
 * The only code that speaks SQL. A change is one transaction, audit row included, and is on disk (fsync) when its
 * function returns. Every function may be called from any thread: writers queue up behind one connection, readers
 * take a read-only connection each from a pool and never wait for a writer.
 *
 * Strings are UTF-8. A NULL string, ESKEL_SIDE_UNKNOWN, ESKEL_SEX_UNKNOWN and a NaN age mean "not recorded". Outputs
 * are written last and untouched on failure; an eskel_store_error may be NULL.
 */
#ifndef ESKEL_STORE_H
#define ESKEL_STORE_H

#include "eskel.h"

#define ESKEL_STORE_STATUSES(X)                                                                                        \
	X(ESKEL_STORE_OK, "no error")                                                                                  \
	X(ESKEL_STORE_INVALID, "an argument is outside its range")                                                     \
	X(ESKEL_STORE_NO_MEMORY, "memory ran out")                                                                     \
	X(ESKEL_STORE_NOT_FOUND, "there is no such row")                                                               \
	X(ESKEL_STORE_CONFLICT, "the row has changed since it was read")                                               \
	X(ESKEL_STORE_FOREIGN, "the file is not an eskel database of a version that this program knows")               \
	X(ESKEL_STORE_LOCKED, "another server has the file open")                                                      \
	X(ESKEL_STORE_BUSY, "the database stayed busy")                                                                \
	X(ESKEL_STORE_FULL, "the disk is full")                                                                        \
	X(ESKEL_STORE_READ_ONLY, "an earlier write could not be made durable: no more writes until a restart")         \
	X(ESKEL_STORE_CORRUPT, "stored bytes do not match their checksum")                                             \
	X(ESKEL_STORE_IO, "the database could not be read or written")

#define ESKEL_STORE_STATUS_CODE(code, text) code,
typedef enum { ESKEL_STORE_STATUSES(ESKEL_STORE_STATUS_CODE) ESKEL_STORE_STATUS_COUNT } eskel_store_status;
#undef ESKEL_STORE_STATUS_CODE

ESKEL_API const char *eskel_store_status_text(eskel_store_status status);

typedef struct {
	eskel_store_status status;
	char text[256];
} eskel_store_error;

/* ---------------------------------------------------------------------------------------------- open */

typedef struct eskel_store eskel_store;

typedef struct {
	uint64_t least_free_bytes; /* enrollment is refused (FULL) when the disk has less; default 64 MiB, so that
	                              deletions still find room */
	bool beside_server;        /* open a file that a server has locked: for tokens and the audit, of which servers
	                              keep nothing in memory. A change of shapes is refused then (LOCKED) */
	bool check_later;          /* leave the check of the tables, seconds for a million shapes, to eskel_store_check */
} eskel_store_options;

/* Creates the file (mode 0600) or opens it, brings its schema up to date step by step, takes its lock, and checks its
 * tables (CORRUPT). A file with another application id or a newer schema is refused untouched (FOREIGN). */
ESKEL_API eskel_store_status eskel_store_open(const char *path, const eskel_store_options *options,
	eskel_store **store, eskel_store_error *error);
ESKEL_API void eskel_store_close(eskel_store *store);
/* What an open with check_later has left, beside reads whose results are of no use if it fails; before any change. */
ESKEL_API eskel_store_status eskel_store_check(eskel_store *store, eskel_store_error *error);

/* OK while reads work and writes are allowed: one cheap read, no lock taken. */
ESKEL_API eskel_store_status eskel_store_ready(eskel_store *store, eskel_store_error *error);

/* ---------------------------------------------------------------------------------------------- shape */

#define ESKEL_ID_SIZE 33
#define ESKEL_SHA256_SIZE 65

typedef enum { ESKEL_SIDE_UNKNOWN, ESKEL_SIDE_LEFT, ESKEL_SIDE_RIGHT, ESKEL_SIDE_NONE } eskel_side;
typedef enum { ESKEL_SEX_UNKNOWN, ESKEL_SEX_FEMALE, ESKEL_SEX_MALE } eskel_sex;

typedef struct {
	char *key, *value;
} eskel_attribute;

/* What people say of a shape. */
typedef struct {
	char *name, *class, *subject;
	eskel_side side;
	eskel_sex sex;
	double age;                      /* years */
	size_t attribute_count;
	eskel_attribute *attributes;     /* ascending unique keys */
} eskel_description;

typedef struct {
	int64_t key;                     /* the row's number: its key in an eskel_library; never used again */
	char id[ESKEL_ID_SIZE];          /* first 32 hex digits of sha256 */
	char sha256[ESKEL_SHA256_SIZE];  /* of the encoded canonical cloud */
	int64_t revision;                /* 1 at first, plus 1 with each change of the description */
	char created[25];                /* UTC, 2026-01-31T12:34:56Z */
	int32_t label;                   /* in the volume that it came from */
	uint64_t voxels;
	double volume;                   /* mm^3 */
	double centre[3];                /* mm, RAS */
	uint32_t levels;
	size_t warning_count;
	eskel_warning *warnings;
	eskel_description description;
} eskel_shape;

/* Frees what the members own, not the struct. */
ESKEL_API void eskel_description_clear(eskel_description *description);
ESKEL_API void eskel_shape_clear(eskel_shape *shape);
ESKEL_API void eskel_shapes_free(eskel_shape *shapes, size_t count);

/* The content id that a cloud has or would have in every store. */
ESKEL_API eskel_store_status eskel_store_identify(const eskel_cloud *cloud, char id[ESKEL_ID_SIZE],
	char sha256[ESKEL_SHA256_SIZE]);

typedef struct {
	const eskel_cloud *cloud;
	const eskel_skeleton *skeleton;
	const eskel_signature *signature;
	const eskel_description *description;
	int32_t label;
	const eskel_warning *warnings;
	size_t warning_count;
} eskel_enrollment;

/* Stores all or none in one transaction. A cloud that is there already, or twice in the call, stays one shape and is
 * left as it is (created[i] false). shapes[count] are read back from the store; eskel_shape_clear each. actor is who
 * asks, for the audit: a token's name or NULL. */
ESKEL_API eskel_store_status eskel_store_enroll(eskel_store *store, const char *actor,
	const eskel_enrollment *enrollments, size_t count, eskel_shape *shapes, bool *created,
	eskel_store_error *error);

ESKEL_API eskel_store_status eskel_store_shape(eskel_store *store, const char *id, eskel_shape *shape,
	eskel_store_error *error);
ESKEL_API eskel_store_status eskel_store_shape_by_key(eskel_store *store, int64_t key, eskel_shape *shape,
	eskel_store_error *error);

/* Replaces the description. revision 0: whatever it is now; otherwise CONFLICT unless it is still that. */
ESKEL_API eskel_store_status eskel_store_describe(eskel_store *store, const char *actor, const char *id,
	int64_t revision, const eskel_description *description, eskel_shape *shape, eskel_store_error *error);
ESKEL_API eskel_store_status eskel_store_delete(eskel_store *store, const char *actor, const char *id,
	int64_t revision, int64_t *key, eskel_store_error *error);

/* The stored objects, their checksums verified (CORRUPT). */
ESKEL_API eskel_store_status eskel_store_cloud(eskel_store *store, int64_t key, eskel_cloud **cloud,
	eskel_store_error *error);
ESKEL_API eskel_store_status eskel_store_skeleton(eskel_store *store, int64_t key, eskel_skeleton **skeleton,
	eskel_store_error *error);
ESKEL_API eskel_store_status eskel_store_signature(eskel_store *store, int64_t key, eskel_signature **signature,
	eskel_store_error *error);

/* ---------------------------------------------------------------------------------------------- list */

/* Every given condition must hold. NULL, UNKNOWN, NaN and 0 mean no condition. */
typedef struct {
	const char *class, *subject, *not_subject;
	eskel_side side;
	eskel_sex sex;
	double age_min, age_max;                 /* NaN: no condition */
	const char *text;                        /* part of the name, class or subject, case folded for ASCII */
	size_t attribute_count;
	const eskel_attribute *attributes;       /* equal values */
} eskel_filter;

/* All of NaN and NULL: no condition. */
ESKEL_API eskel_filter eskel_filter_none(void);
ESKEL_API bool eskel_filter_is_none(const eskel_filter *filter);

/* At most limit shapes with key > after, ascending; *more says whether others follow. */
ESKEL_API eskel_store_status eskel_store_list(eskel_store *store, const eskel_filter *filter, int64_t after,
	size_t limit, eskel_shape **shapes, size_t *count, bool *more, eskel_store_error *error);
/* The keys alone: what a search compares with. free() them; not NULL when there are none. */
ESKEL_API eskel_store_status eskel_store_keys(eskel_store *store, const eskel_filter *filter, eskel_key_block **keys,
	size_t *block_count, eskel_store_error *error);
/* The classes of all shapes, ascending, each once. Free them. */
ESKEL_API eskel_store_status eskel_store_classes(eskel_store *store, char ***classes, size_t *count,
	eskel_store_error *error);
ESKEL_API void eskel_store_classes_free(char **classes, size_t count);
ESKEL_API eskel_store_status eskel_store_count(eskel_store *store, uint64_t *count, eskel_store_error *error);

/* From now on what filters look at is kept in memory, and eskel_store_keys reads the database only for a filter with text.
 * To be called once, before the store is used by other threads. */
ESKEL_API eskel_store_status eskel_store_keep_descriptions(eskel_store *store, eskel_store_error *error);

/* What becomes of signatures that are read: each is made into something, by several threads at once, and that is taken by
 * the calling thread alone, in ascending order of keys. */
typedef struct {
	/* The signature is the store's, valid during the call. NULL: memory ran out. */
	void *(*make)(void *context, const eskel_signature *signature);
	/* Owns what was made; false stops (OK is returned). */
	bool (*take)(void *context, int64_t key, void *made);
	void (*drop)(void *made);                /* frees what is not taken */
	void *context;
} eskel_signature_visitor;

/* Every signature in one consistent read. */
ESKEL_API eskel_store_status eskel_store_each_signature(eskel_store *store, const eskel_signature_visitor *visitor,
	eskel_store_error *error);

/* ---------------------------------------------------------------------------------------------- tokens */

typedef enum { ESKEL_ROLE_READ = 1, ESKEL_ROLE_WRITE, ESKEL_ROLE_ADMIN } eskel_role; /* each includes those before */

#define ESKEL_TOKEN_TEXT_SIZE 65

typedef struct {
	int64_t number;
	char name[65];
	eskel_role role;
	int64_t created, expires, revoked;       /* Unix seconds; 0: never */
} eskel_token;

/* Makes a token of 32 random bytes; its hex text is shown here once, only its SHA-256 is kept. */
ESKEL_API eskel_store_status eskel_store_token_add(eskel_store *store, const char *name, eskel_role role,
	int64_t expires, char text[ESKEL_TOKEN_TEXT_SIZE], eskel_token *token, eskel_store_error *error);
ESKEL_API eskel_store_status eskel_store_token_revoke(eskel_store *store, int64_t number, eskel_store_error *error);
/* free() the array. */
ESKEL_API eskel_store_status eskel_store_tokens(eskel_store *store, eskel_token **tokens, size_t *count,
	eskel_store_error *error);
/* NOT_FOUND for a token that is unknown, expired or revoked at the time now; all take the same time. */
ESKEL_API eskel_store_status eskel_store_token_verify(eskel_store *store, const char *text, int64_t now,
	eskel_token *token, eskel_store_error *error);

/* ---------------------------------------------------------------------------------------------- surfaces */

/* A surface fitted to a shape's level with one kind of primitive. */
typedef struct {
	uint32_t level;
	const char *primitive;           /* the caller's */
	char *summary;                   /* of the fit, in the words of the API */
	uint8_t *bytes;                  /* of eskel_surface_encode */
	size_t size;
	char sha256[ESKEL_SHA256_SIZE];  /* of the bytes, when it was read */
} eskel_fitted;

ESKEL_API void eskel_fitted_clear(eskel_fitted *fitted);
/* Stores it in the place of the last; it goes with its shape. NOT_FOUND when that is gone. */
ESKEL_API eskel_store_status eskel_store_surface_put(eskel_store *store, int64_t key, const eskel_fitted *fitted,
	eskel_store_error *error);
/* NOT_FOUND when none was fitted, CORRUPT when it is damaged. */
ESKEL_API eskel_store_status eskel_store_surface(eskel_store *store, int64_t key, uint32_t level,
	const char *primitive, eskel_fitted *fitted, eskel_store_error *error);

/* ---------------------------------------------------------------------------------------------- jobs */

typedef enum { ESKEL_JOB_QUEUED, ESKEL_JOB_DONE, ESKEL_JOB_FAILED } eskel_job_state;

/* Something to be answered when nobody waits for it, and how that ended. */
typedef struct {
	char id[ESKEL_ID_SIZE];
	char created[25];                /* as a shape's */
	char *request;                   /* what to answer, in the words of the API */
	eskel_job_state state;
	uint32_t starts;                 /* how often it was begun, to know one that brings the server down */
	int status;                      /* of the answer; 0 before */
	char content_type[65];           /* "" before */
	uint64_t size;                   /* bytes of the answer */
	double seconds;                  /* that it ran */
	char problem[640];               /* why it failed, "" unless it did */
} eskel_job;

/* Stores a new one, of its id and request; fills in created. */
ESKEL_API eskel_store_status eskel_store_job_add(eskel_store *store, eskel_job *job, eskel_store_error *error);
/* Stores what changes of it. One that is gone stays so. */
ESKEL_API eskel_store_status eskel_store_job_update(eskel_store *store, const eskel_job *job,
	eskel_store_error *error);
ESKEL_API eskel_store_status eskel_store_job_remove(eskel_store *store, const char *id, eskel_store_error *error);
/* In the order of their addition. */
ESKEL_API eskel_store_status eskel_store_jobs(eskel_store *store, eskel_job **jobs, size_t *count,
	eskel_store_error *error);
ESKEL_API void eskel_jobs_free(eskel_job *jobs, size_t count);

/* ---------------------------------------------------------------------------------------------- files */

/* What is too large for rows and can be made again: files in a folder beside the database, "shapes.db-NAME", mode 0700. A
 * file appears under its name when it is whole and on disk, and carries its SHA-256. Names are the caller's: letters,
 * digits and hyphens, at most 120. A folder and its files may be used by any thread, a file that is written by one at a time. */
typedef struct eskel_folder eskel_folder;
typedef struct eskel_file eskel_file;

/* Makes it if there is none; removes what was left half written. */
ESKEL_API eskel_store_status eskel_folder_open(eskel_store *store, const char *name, eskel_folder **folder,
	eskel_store_error *error);
ESKEL_API void eskel_folder_close(eskel_folder *folder);
/* Shows each file, in no order, and when it was last written or touched, Unix nanoseconds; false removes it. size is without
 * the digest. Removes what is half written, too: the caller sees to it that nobody is writing. */
ESKEL_API eskel_store_status eskel_folder_each(eskel_folder *folder,
	bool (*keep)(void *context, const char *name, uint64_t size, int64_t used), void *context,
	eskel_store_error *error);
/* Makes now the time of its last use. */
ESKEL_API void eskel_folder_touch(eskel_folder *folder, const char *name);
/* One that is not there is fine, one that is being read stays until it is closed. */
ESKEL_API void eskel_folder_remove(eskel_folder *folder, const char *name);

/* The SHA-256 of bytes in hex: a name. */
ESKEL_API void eskel_digest(const void *bytes, size_t size, char text[ESKEL_SHA256_SIZE]);

/* A new file, to be kept or discarded. FULL when the disk has less room than the store leaves (least_free_bytes). */
ESKEL_API eskel_store_status eskel_file_create(eskel_folder *folder, const char *name, eskel_file **file,
	eskel_store_error *error);
ESKEL_API eskel_store_status eskel_file_write(eskel_file *file, const void *bytes, size_t size,
	eskel_store_error *error);
/* On disk, under its name in the place of any other, when it returns. Takes the file in any case. */
ESKEL_API eskel_store_status eskel_file_keep(eskel_file *file, eskel_store_error *error);
ESKEL_API void eskel_file_discard(eskel_file *file);

/* A descriptor to read size bytes from, to be closed. NOT_FOUND without such a file. With verify it is read whole first:
 * CORRUPT if it is damaged, or no file of ours. */
ESKEL_API eskel_store_status eskel_file_open(eskel_folder *folder, const char *name, bool verify, int *descriptor,
	uint64_t *size, eskel_store_error *error);

/* ---------------------------------------------------------------------------------------------- audit */

/* Each change (enroll, describe, delete, token add, token revoke) has one audit row, whose hash covers the row before.
 * CORRUPT names the first row that breaks the chain. */
ESKEL_API eskel_store_status eskel_store_audit_verify(eskel_store *store, uint64_t *rows, eskel_store_error *error);

#endif
