/* What the store does on a disk that fills up: full_disk FOLDER, a small disk of its own. */
#include "store_sample.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static eskel_store *store;
static eskel_store_error error;

static void expect(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "not so: %s; the store's last error: %s\n", what, error.text);
	exit(1);
}

/* Enrolls samples from first on until one is refused, which has to be for the disk. Returns how many were stored. */
static uint32_t enroll_until_full(uint32_t first)
{
	for (uint32_t count = 0; count < 10000; count++) {
		eskel_store_status status = sample_enroll(store, first + count, NULL, &error);
		if (status == ESKEL_STORE_OK)
			continue;
		expect(status == ESKEL_STORE_FULL, "a full disk is reported as FULL");
		return count;
	}
	expect(false, "the disk fills up");
	return 0;
}

static void expect_all_readable(uint64_t expected)
{
	eskel_filter none = eskel_filter_none();
	eskel_shape *shapes = NULL;
	size_t count = 0;
	bool more;
	expect(eskel_store_list(store, &none, 0, 10000, &shapes, &count, &more, &error) == ESKEL_STORE_OK, "lists");
	expect(count == expected, "every acknowledged shape is in the list, and no other");
	for (size_t i = 0; i < count; i++) {
		eskel_cloud *cloud = NULL;
		expect(eskel_store_cloud(store, shapes[i].key, &cloud, &error) == ESKEL_STORE_OK,
			"clouds are readable");
		eskel_cloud_free(cloud);
	}
	eskel_shapes_free(shapes, count);
}

static void delete_first(void)
{
	eskel_filter none = eskel_filter_none();
	eskel_shape *shapes = NULL;
	size_t count = 0;
	bool more;
	int64_t key;
	expect(eskel_store_list(store, &none, 0, 1, &shapes, &count, &more, &error) == ESKEL_STORE_OK, "lists");
	expect(eskel_store_delete(store, NULL, shapes[0].id, 0, &key, &error) == ESKEL_STORE_OK, "deletes");
	eskel_shapes_free(shapes, count);
}

/* Leaves room for a part of an enrollment: the disk ends inside its transaction. */
static void fill(const char *path)
{
	static const char block[4096];
	const off_t left = 80 << 10;
	int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
	while (write(file, block, sizeof block) == (ssize_t)sizeof block)
		continue;
	expect(ftruncate(file, lseek(file, 0, SEEK_CUR) - left) == 0, "the filler gives some room back");
	close(file);
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return 2;
	char *database = scratch_path(argv[1], "shapes.db"), *filler = scratch_path(argv[1], "filler");
	const eskel_store_options reserve = {.least_free_bytes = 2 << 20}, no_reserve = {.least_free_bytes = 1};

	expect(eskel_store_open(database, &reserve, &store, &error) == ESKEL_STORE_OK, "a new store opens");
	uint32_t stored = enroll_until_full(0);
	expect(stored > 0, "something fits");
	expect_all_readable(stored);
	delete_first();
	expect_all_readable(stored - 1);
	eskel_store_close(store);

	expect(eskel_store_open(database, &no_reserve, &store, &error) == ESKEL_STORE_OK, "it opens again");
	fill(filler);
	uint32_t more = enroll_until_full(stored);
	expect(strstr(error.text, "SQLite") != NULL, "the disk ended inside a transaction");
	expect(eskel_store_ready(store, &error) == ESKEL_STORE_OK, "a full disk does not end the writes for good");
	expect_all_readable(stored - 1 + more);
	expect(unlink(filler) == 0, "the filler goes");
	delete_first();
	expect(sample_enroll(store, stored + more, NULL, &error) == ESKEL_STORE_OK, "enrolls when there is room again");
	uint64_t rows = 0;
	expect(eskel_store_audit_verify(store, &rows, &error) == ESKEL_STORE_OK, "the audit is whole");
	eskel_store_close(store);
	printf("%u shapes until the reserve, %u more on a full disk\n", stored, more);
	free(database);
	free(filler);
	return 0;
}
