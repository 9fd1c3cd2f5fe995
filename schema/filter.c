/* Filters as SQL: one condition for each thing that is asked, so that SQLite can choose an index for them. Values are
 * bound, never written into the SQL. */
#include "array.h"
#include "description.h"
#include "read.h"
#include "shape.h"
#include "statement.h"
#include "status.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* So many conditions keep the SQL below the limits of connection.c. */
static const size_t most_attributes = 64;

eskel_filter eskel_filter_none(void)
{
	return (eskel_filter){.age_min = NAN, .age_max = NAN};
}

bool eskel_filter_is_none(const eskel_filter *f)
{
	return !f->class && !f->subject && !f->not_subject && !f->side && !f->sex && isnan(f->age_min) &&
	       isnan(f->age_max) && !f->text && !f->attribute_count;
}

static char *write_sql(const eskel_filter *f)
{
	sqlite3_str *sql = sqlite3_str_new(NULL);
	sqlite3_str_appendall(sql, "SELECT key FROM shape WHERE key > ?");
	if (f->class)
		sqlite3_str_appendall(sql, " AND class = ?");
	if (f->subject)
		sqlite3_str_appendall(sql, " AND subject = ?");
	if (f->not_subject)
		sqlite3_str_appendall(sql, " AND subject IS NOT ?");
	if (f->side)
		sqlite3_str_appendall(sql, " AND side = ?");
	if (f->sex)
		sqlite3_str_appendall(sql, " AND sex = ?");
	if (!isnan(f->age_min))
		sqlite3_str_appendall(sql, " AND age >= ?");
	if (!isnan(f->age_max))
		sqlite3_str_appendall(sql, " AND age <= ?");
	if (f->text)
		sqlite3_str_appendall(sql, " AND (instr(lower(name), lower(?)) OR instr(lower(class), lower(?))"
					   " OR instr(lower(subject), lower(?)))");
	for (size_t i = 0; i < f->attribute_count; i++)
		sqlite3_str_appendall(sql, " AND key IN (SELECT shape FROM attribute WHERE key = ? AND value = ?)");
	sqlite3_str_appendall(sql, " ORDER BY key LIMIT ?");
	return sqlite3_str_finish(sql);
}

/* In the order of write_sql. A negative limit is none. */
static void bind(esk_statement *s, const eskel_filter *f, int64_t after, int64_t limit)
{
	esk_bind_int64(s, after);
	if (f->class)
		esk_bind_text(s, f->class);
	if (f->subject)
		esk_bind_text(s, f->subject);
	if (f->not_subject)
		esk_bind_text(s, f->not_subject);
	if (f->side)
		esk_bind_text(s, esk_side_name(f->side));
	if (f->sex)
		esk_bind_text(s, esk_sex_name(f->sex));
	if (!isnan(f->age_min))
		esk_bind_double(s, f->age_min);
	if (!isnan(f->age_max))
		esk_bind_double(s, f->age_max);
	for (int column = 0; f->text && column < 3; column++)
		esk_bind_text(s, f->text);
	for (size_t i = 0; i < f->attribute_count; i++) {
		esk_bind_text(s, f->attributes[i].key);
		esk_bind_text(s, f->attributes[i].value);
	}
	esk_bind_int64(s, limit);
}

static eskel_store_status check(const eskel_filter *filter, eskel_store_error *error)
{
	if (filter->attribute_count <= most_attributes)
		return ESKEL_STORE_OK;
	return esk_status_fail(error, ESKEL_STORE_INVALID, "the filter has %zu attributes, expected at most %zu",
		filter->attribute_count, most_attributes);
}

static eskel_store_status find_keys(sqlite3 *db, const eskel_filter *filter, int64_t after, int64_t limit,
	int64_t **keys, size_t *count, eskel_store_error *error)
{
	char *sql = write_sql(filter);
	if (!sql)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	int64_t *found = NULL;
	size_t found_count = 0;
	esk_statement s = esk_statement_begin_once(db, sql);
	bind(&s, filter, after, limit);
	/* Room is made before a row is read: no row at all is an array too, for NULL means "all" to a search. */
	bool room = esk_array_grow((void **)&found, 0, sizeof found[0]);
	while (room && esk_statement_row(&s)) {
		found[found_count++] = esk_column_int64(&s);
		room = esk_array_grow((void **)&found, found_count, sizeof found[0]);
	}
	if (!room)
		esk_statement_fail(&s, SQLITE_NOMEM);
	eskel_store_status status = esk_statement_end(&s, error);
	sqlite3_free(sql);
	if (status != ESKEL_STORE_OK) {
		free(found);
		return status;
	}
	*keys = found;
	*count = found_count;
	return ESKEL_STORE_OK;
}

static eskel_store_status pack(
	const int64_t *keys, size_t count, eskel_key_block **blocks, size_t *block_count, eskel_store_error *error)
{
	eskel_key_block *packed = malloc((count + 1) * sizeof *packed);
	if (!packed)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	*block_count = 0;
	for (size_t i = 0; i < count; i++)
		*block_count = eskel_key_blocks_add(packed, *block_count, keys[i], 1);
	*blocks = packed;
	return ESKEL_STORE_OK;
}

eskel_store_status eskel_store_keys(eskel_store *store, const eskel_filter *filter, eskel_key_block **keys,
	size_t *block_count, eskel_store_error *error)
{
	int64_t *found = NULL;
	size_t count = 0;
	sqlite3 *db = NULL;
	eskel_store_status status = check(filter, error);
	if (status == ESKEL_STORE_OK && esk_catalogue_keys(store->catalogue, filter, keys, block_count))
		return ESKEL_STORE_OK;
	if (status == ESKEL_STORE_OK)
		status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = find_keys(db, filter, INT64_MIN, -1, &found, &count, error);
	esk_read_end(store, db);
	if (status == ESKEL_STORE_OK)
		status = pack(found, count, keys, block_count, error);
	free(found);
	return status;
}

static eskel_store_status read_shapes(
	sqlite3 *db, const int64_t *keys, size_t count, eskel_shape **shapes, eskel_store_error *error)
{
	eskel_shape *read = calloc(count ? count : 1, sizeof read[0]);
	if (!read)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	eskel_store_status status = ESKEL_STORE_OK;
	for (size_t i = 0; i < count && status == ESKEL_STORE_OK; i++)
		status = esk_shape_read(db, keys[i], &read[i], error);
	if (status != ESKEL_STORE_OK) {
		eskel_shapes_free(read, count);
		return status;
	}
	*shapes = read;
	return ESKEL_STORE_OK;
}

eskel_store_status eskel_store_list(eskel_store *store, const eskel_filter *filter, int64_t after, size_t limit,
	eskel_shape **shapes, size_t *count, bool *more, eskel_store_error *error)
{
	if (limit >= INT64_MAX)
		return esk_status_fail(error, ESKEL_STORE_INVALID, "the limit is %zu, expected less", limit);
	int64_t *keys = NULL;
	size_t found = 0;
	sqlite3 *db = NULL;
	eskel_store_status status = check(filter, error);
	if (status == ESKEL_STORE_OK)
		status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = find_keys(db, filter, after, (int64_t)limit + 1, &keys, &found, error);
	size_t wanted = found > limit ? limit : found;
	if (status == ESKEL_STORE_OK)
		status = read_shapes(db, keys, wanted, shapes, error);
	esk_read_end(store, db);
	free(keys);
	if (status != ESKEL_STORE_OK)
		return status;
	*count = wanted;
	*more = found > wanted;
	return ESKEL_STORE_OK;
}
