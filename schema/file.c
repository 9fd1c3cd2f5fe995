#include "file.h"

#include "status.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/statvfs.h>
#include <unistd.h>

static eskel_store_status fail(eskel_store_error *error, const char *path, const char *what)
{
	return esk_status_fail(error, ESKEL_STORE_IO, "%s cannot be %s: %s", path, what, strerror(errno));
}

eskel_store_status esk_file_resolve(const char *path, char **resolved, eskel_store_error *error)
{
	char *real = realpath(path, NULL);
	if (!real && errno == ENOENT) {
		int created = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
		if (created < 0)
			return fail(error, path, "created");
		close(created);
		real = realpath(path, NULL);
	}
	if (!real)
		return fail(error, path, "opened");
	*resolved = real;
	return ESKEL_STORE_OK;
}

static char *lock_path(const char *path)
{
	char *locked = NULL;
	return asprintf(&locked, "%s-lock", path) < 0 ? NULL : locked;
}

eskel_store_status esk_file_lock(const char *path, int *lock, eskel_store_error *error)
{
	char *beside = lock_path(path);
	if (!beside)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	eskel_store_status status = ESKEL_STORE_OK;
	int opened = open(beside, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
	if (opened < 0)
		status = fail(error, beside, "opened");
	else if (flock(opened, LOCK_EX | LOCK_NB) == 0)
		*lock = opened;
	else if (errno == EWOULDBLOCK)
		status = esk_status_fail(error, ESKEL_STORE_LOCKED, "another server has %s open", path);
	else
		status = fail(error, beside, "locked");
	if (status != ESKEL_STORE_OK && opened >= 0)
		close(opened);
	free(beside);
	return status;
}

void esk_file_unlock_and_remove(const char *path, int *lock)
{
	char *beside = lock_path(path);
	if (beside)
		unlink(beside);
	free(beside);
	close(*lock);
	*lock = -1;
}

static uint32_t big_endian(const uint8_t *b)
{
	return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* Zeros are what a crash leaves of a file that SQLite had begun to create; its journal makes it empty again. */
static bool is_zero(const uint8_t *bytes, size_t size)
{
	for (size_t i = 0; i < size; i++)
		if (bytes[i])
			return false;
	return true;
}

static eskel_store_status check_header(
	const char *path, const uint8_t *header, size_t size, int newest_version, eskel_store_error *error)
{
	static const char magic[16] = "SQLite format 3";
	if (is_zero(header, size))
		return ESKEL_STORE_OK;
	if (size < 100 || memcmp(header, magic, sizeof magic) != 0)
		return esk_status_fail(error, ESKEL_STORE_FOREIGN, "%s is not an SQLite database", path);
	uint32_t version = big_endian(header + 60), application = big_endian(header + 68);
	if (application != ESK_APPLICATION_ID)
		return esk_status_fail(error, ESKEL_STORE_FOREIGN,
			"%s is a database of another program: its application id is %08" PRIx32 ", expected %08x", path,
			application, (unsigned)ESK_APPLICATION_ID);
	if (version > (uint32_t)newest_version)
		return esk_status_fail(error, ESKEL_STORE_FOREIGN,
			"%s was written by a newer program: its schema is %" PRIu32 ", expected at most %d", path,
			version, newest_version);
	return ESKEL_STORE_OK;
}

eskel_store_status esk_file_check(const char *path, int newest_version, eskel_store_error *error)
{
	uint8_t header[100];
	int file = open(path, O_RDONLY | O_CLOEXEC);
	if (file < 0)
		return fail(error, path, "opened");
	ssize_t size = pread(file, header, sizeof header, 0);
	eskel_store_status status =
		size < 0 ? fail(error, path, "read") : check_header(path, header, (size_t)size, newest_version, error);
	close(file);
	return status;
}

eskel_store_status esk_file_check_room(const char *path, uint64_t bytes, eskel_store_error *error)
{
	struct statvfs disk;
	if (statvfs(path, &disk) != 0)
		return esk_status_fail(
			error, ESKEL_STORE_IO, "the free space of the disk cannot be read: %s", strerror(errno));
	uint64_t room = (uint64_t)disk.f_bavail * disk.f_frsize;
	if (room < bytes)
		return esk_status_fail(error, ESKEL_STORE_FULL,
			"the disk has %" PRIu64 " bytes free, expected at least %" PRIu64, room, bytes);
	return ESKEL_STORE_OK;
}
