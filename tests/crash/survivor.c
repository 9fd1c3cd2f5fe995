/* The program that is killed, and the one that looks what survived.
 *
 *	survivor change DATABASE FIRST [power|lying]    enrolls and deletes samples FIRST, FIRST + 1, ... for ever
 *	survivor check DATABASE ACKNOWLEDGED            0 when every acknowledged change is there
 *
 * "change" prints a line after each call has returned: +ID enrolled, ?ID about to be deleted, -ID deleted. The lines of
 * all runs together are the file ACKNOWLEDGED. */
#include "fault_vfs.h"
#include "store_sample.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { thread_count = 3 };

static void demand(eskel_store_status status, const eskel_store_error *error)
{
	if (status == ESKEL_STORE_OK)
		return;
	fprintf(stderr, "%s\n", error->text);
	exit(1);
}

/* ------------------------------------------------------------------------------------------------ change */

/* One write(2) a line: it is whole or not there, and outlives the process. */
static void acknowledge(char sign, const char *id)
{
	char line[ESKEL_ID_SIZE + 2];
	snprintf(line, sizeof line, "%c%s\n", sign, id);
	if (write(STDOUT_FILENO, line, sizeof line - 1) < 0)
		exit(1);
}

typedef struct {
	eskel_store *store;
	uint32_t first;
} job;

static void *change(void *context)
{
	const job *j = context;
	eskel_store_error error;
	for (uint32_t number = j->first;; number += thread_count) {
		eskel_shape shape;
		int64_t key;
		demand(sample_enroll(j->store, number, &shape, &error), &error);
		acknowledge('+', shape.id);
		if (number % 5 == 0) {
			acknowledge('?', shape.id);
			demand(eskel_store_delete(j->store, NULL, shape.id, 0, &key, &error), &error);
			acknowledge('-', shape.id);
		}
		eskel_shape_clear(&shape);
	}
	return NULL;
}

static int change_until_killed(const char *database, uint32_t first)
{
	eskel_store_error error;
	eskel_store *store = NULL;
	demand(eskel_store_open(database, NULL, &store, &error), &error);
	pthread_t threads[thread_count];
	job jobs[thread_count];
	for (uint32_t i = 0; i < thread_count; i++) {
		jobs[i] = (job){store, first + i};
		if (pthread_create(&threads[i], NULL, change, &jobs[i]) != 0)
			return 1;
	}
	pthread_join(threads[0], NULL);
	return 1;
}

/* ------------------------------------------------------------------------------------------------ check */

typedef struct {
	char sign, id[ESKEL_ID_SIZE];
	size_t line;
} acknowledged;

/* By id, then in the order in which they were printed. */
static int compare(const void *a, const void *b)
{
	const acknowledged *x = a, *y = b;
	int order = strcmp(x->id, y->id);
	return order ? order : x->line < y->line ? -1 : 1;
}

static size_t read_lines(const char *path, acknowledged **lines)
{
	size_t size, count = 0;
	char *text = (char *)file_read(path, &size);
	*lines = calloc(size / (ESKEL_ID_SIZE + 1) + 1, sizeof **lines);
	for (size_t at = 0; at + ESKEL_ID_SIZE + 1 <= size; at += ESKEL_ID_SIZE + 1, count++) {
		acknowledged *l = &(*lines)[count];
		l->sign = text[at];
		l->line = count;
		memcpy(l->id, text + at + 1, ESKEL_ID_SIZE - 1);
	}
	free(text);
	qsort(*lines, count, sizeof **lines, compare);
	return count;
}

/* The row, all three blobs, and the cloud is the one that was enrolled. */
static bool is_whole(eskel_store *store, const char *id)
{
	eskel_shape shape;
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_signature *signature = NULL;
	char cloud_id[ESKEL_ID_SIZE], sha256[ESKEL_SHA256_SIZE];
	if (eskel_store_shape(store, id, &shape, NULL) != ESKEL_STORE_OK)
		return false;
	bool whole = eskel_store_cloud(store, shape.key, &cloud, NULL) == ESKEL_STORE_OK &&
		     eskel_store_skeleton(store, shape.key, &skeleton, NULL) == ESKEL_STORE_OK &&
		     eskel_store_signature(store, shape.key, &signature, NULL) == ESKEL_STORE_OK &&
		     eskel_store_identify(cloud, cloud_id, sha256) == ESKEL_STORE_OK && strcmp(cloud_id, id) == 0;
	eskel_cloud_free(cloud);
	eskel_skeleton_free(skeleton);
	eskel_signature_free(signature);
	eskel_shape_clear(&shape);
	return whole;
}

static bool is_gone(eskel_store *store, const char *id)
{
	eskel_shape shape;
	eskel_store_status status = eskel_store_shape(store, id, &shape, NULL);
	if (status == ESKEL_STORE_OK)
		eskel_shape_clear(&shape);
	return status == ESKEL_STORE_NOT_FOUND;
}

static int check(const char *database, const char *path)
{
	eskel_store_error error;
	eskel_store *store = NULL;
	acknowledged *lines = NULL;
	size_t count = read_lines(path, &lines), lost = 0, undone = 0;
	uint64_t rows = 0, shapes = 0;
	demand(eskel_store_open(database, NULL, &store, &error), &error);
	for (size_t i = 0; i < count; i++) {
		bool is_last = i + 1 == count || strcmp(lines[i].id, lines[i + 1].id) != 0;
		lost += is_last && lines[i].sign == '+' && !is_whole(store, lines[i].id);
		undone += is_last && lines[i].sign == '-' && !is_gone(store, lines[i].id);
	}
	demand(eskel_store_audit_verify(store, &rows, &error), &error);
	demand(eskel_store_count(store, &shapes, &error), &error);
	printf("%zu acknowledged, %zu lost, %zu deletions undone; %llu shapes, %llu audit rows\n", count, lost, undone,
		(unsigned long long)shapes, (unsigned long long)rows);
	eskel_store_close(store);
	free(lines);
	return lost || undone || count == 0;
}

int main(int argc, char **argv)
{
	if (argc == 4 && strcmp(argv[1], "check") == 0)
		return check(argv[2], argv[3]);
	if (argc < 4 || strcmp(argv[1], "change") != 0) {
		fprintf(stderr, "usage: survivor change DATABASE FIRST [power|lying] | check DATABASE ACKNOWLEDGED\n");
		return 2;
	}
	if (argc == 5)
		fault_vfs_install(strcmp(argv[4], "lying") == 0 ? FAULT_VFS_LYING_DISK : FAULT_VFS_POWER_LOSS);
	return change_until_killed(argv[2], (uint32_t)strtoul(argv[3], NULL, 10));
}
