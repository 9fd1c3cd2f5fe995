/* Files beside the database: written under a temporary name, synced, renamed, and the folder synced, as is the one that it
 * stands in when it is made. The digest stands behind the bytes, so that these start at the file's start and are hashed as
 * they come. */
#include "file.h"
#include "sha256.h"
#include "status.h"
#include "store.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <nettle/sha2.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_NAME = 120, PIECE = 1 << 16 };

static const char unfinished[] = ".part"; /* a temporary name is NAME.N.part; no name has a dot */

struct eskel_folder {
	char *path;
	int directory;
	uint64_t least_free_bytes;
	atomic_uint made; /* files, so that two of one name that are written at once have not the same temporary one */
};

struct eskel_file {
	eskel_folder *folder;
	char name[MOST_NAME + 1], temporary[MOST_NAME + 24];
	int descriptor;
	struct sha256_ctx digest;
};

static eskel_store_status fail(eskel_store_error *error, const eskel_folder *folder, const char *what)
{
	const eskel_store_status status = errno == ENOSPC || errno == EDQUOT ? ESKEL_STORE_FULL : ESKEL_STORE_IO;
	return esk_status_fail(error, status, "a file in %s cannot be %s: %s", folder->path, what, strerror(errno));
}

static eskel_store_status no_memory(eskel_store_error *error)
{
	return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
}

/* ---- the folder */

static bool is_unfinished(const char *name)
{
	const size_t length = strlen(name), end = sizeof unfinished - 1;
	return length > end && strcmp(name + length - end, unfinished) == 0;
}

/* A name is on disk when the folder that it stands in is. */
static eskel_store_status sync_name(const eskel_folder *folder, eskel_store_error *error)
{
	const int parent = openat(folder->directory, "..", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	const bool synced = parent >= 0 && fsync(parent) == 0;
	const eskel_store_status status = synced ? ESKEL_STORE_OK : fail(error, folder, "synced");
	if (parent >= 0)
		close(parent);
	return status;
}

/* A folder that somebody else has put there is not ours to write into. */
static eskel_store_status open_directory(eskel_folder *folder, eskel_store_error *error)
{
	struct stat is;
	const bool made = mkdir(folder->path, 0700) == 0;
	if (!made && errno != EEXIST)
		return fail(error, folder, "made");
	folder->directory = open(folder->path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
	if (folder->directory < 0 || fstat(folder->directory, &is) != 0)
		return fail(error, folder, "opened");
	if (is.st_uid != geteuid() || (is.st_mode & 077))
		return esk_status_fail(error, ESKEL_STORE_FOREIGN,
			"%s belongs to user %u and has the mode %03o, expected user %u and mode 700", folder->path,
			(unsigned)is.st_uid, (unsigned)is.st_mode & 0777, (unsigned)geteuid());
	return made ? sync_name(folder, error) : ESKEL_STORE_OK;
}

static bool keep_all(void *context, const char *name, uint64_t size, int64_t used)
{
	(void)context;
	(void)name;
	(void)size;
	(void)used;
	return true;
}

eskel_store_status eskel_folder_open(
	eskel_store *store, const char *name, eskel_folder **folder, eskel_store_error *error)
{
	eskel_folder *opened = calloc(1, sizeof *opened);
	if (!opened)
		return no_memory(error);
	opened->directory = -1;
	opened->least_free_bytes = store->least_free_bytes;
	eskel_store_status status =
		asprintf(&opened->path, "%s-%s", store->path, name) < 0 ? no_memory(error) : ESKEL_STORE_OK;
	if (status == ESKEL_STORE_OK)
		status = open_directory(opened, error);
	if (status == ESKEL_STORE_OK)
		status = eskel_folder_each(opened, keep_all, NULL, error);
	if (status == ESKEL_STORE_OK)
		*folder = opened;
	else
		eskel_folder_close(opened);
	return status;
}

void eskel_folder_close(eskel_folder *folder)
{
	if (!folder)
		return;
	if (folder->directory >= 0)
		close(folder->directory);
	free(folder->path);
	free(folder);
}

void eskel_folder_remove(eskel_folder *folder, const char *name)
{
	unlinkat(folder->directory, name, 0);
}

void eskel_folder_touch(eskel_folder *folder, const char *name)
{
	utimensat(folder->directory, name, NULL, AT_SYMLINK_NOFOLLOW);
}

static bool is_wanted(const eskel_folder *folder, const char *name,
	bool (*keep)(void *context, const char *name, uint64_t size, int64_t used), void *context)
{
	struct stat is;
	if (fstatat(folder->directory, name, &is, AT_SYMLINK_NOFOLLOW) != 0 || S_ISDIR(is.st_mode))
		return true;
	return !is_unfinished(name) && S_ISREG(is.st_mode) && is.st_size >= ESK_SHA256_BYTES &&
	       keep(context, name, (uint64_t)is.st_size - ESK_SHA256_BYTES,
		       (int64_t)is.st_mtim.tv_sec * 1000000000 + is.st_mtim.tv_nsec);
}

eskel_store_status eskel_folder_each(eskel_folder *folder,
	bool (*keep)(void *context, const char *name, uint64_t size, int64_t used), void *context,
	eskel_store_error *error)
{
	/* a description of its own, for its place in the list is its own */
	const int again = openat(folder->directory, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	DIR *entries = again < 0 ? NULL : fdopendir(again);
	if (!entries) {
		if (again >= 0)
			close(again);
		return fail(error, folder, "listed");
	}
	for (struct dirent *entry; (entry = readdir(entries));)
		if (!is_wanted(folder, entry->d_name, keep, context))
			eskel_folder_remove(folder, entry->d_name);
	closedir(entries);
	return ESKEL_STORE_OK;
}

/* ---- writing */

eskel_store_status eskel_file_create(
	eskel_folder *folder, const char *name, eskel_file **file, eskel_store_error *error)
{
	eskel_file *made = calloc(1, sizeof *made);
	if (!made)
		return no_memory(error);
	made->folder = folder;
	snprintf(made->name, sizeof made->name, "%s", name);
	snprintf(made->temporary, sizeof made->temporary, "%s.%u%s", made->name, atomic_fetch_add(&folder->made, 1),
		unfinished);
	sha256_init(&made->digest);
	made->descriptor = openat(folder->directory, made->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (made->descriptor < 0) {
		const eskel_store_status status = fail(error, folder, "created");
		free(made);
		return status;
	}
	*file = made;
	return ESKEL_STORE_OK;
}

static eskel_store_status write_all(eskel_file *file, const uint8_t *bytes, size_t size, eskel_store_error *error)
{
	while (size > 0) {
		const ssize_t written = write(file->descriptor, bytes, size);
		if (written < 0 && errno != EINTR)
			return fail(error, file->folder, "written");
		if (written > 0) {
			bytes += written;
			size -= (size_t)written;
		}
	}
	return ESKEL_STORE_OK;
}

eskel_store_status eskel_file_write(eskel_file *file, const void *bytes, size_t size, eskel_store_error *error)
{
	eskel_store_status status = esk_file_check_room(file->folder->path, file->folder->least_free_bytes, error);
	if (status != ESKEL_STORE_OK)
		return status;
	sha256_update(&file->digest, size, bytes);
	return write_all(file, bytes, size, error);
}

static eskel_store_status publish(eskel_file *file, eskel_store_error *error)
{
	const int directory = file->folder->directory;
	if (fsync(file->descriptor) != 0)
		return fail(error, file->folder, "synced");
	if (renameat(directory, file->temporary, directory, file->name) != 0)
		return fail(error, file->folder, "renamed");
	return fsync(directory) == 0 ? ESKEL_STORE_OK : fail(error, file->folder, "synced");
}

eskel_store_status eskel_file_keep(eskel_file *file, eskel_store_error *error)
{
	uint8_t digest[ESK_SHA256_BYTES];
	sha256_digest(&file->digest, sizeof digest, digest);
	eskel_store_status status = write_all(file, digest, sizeof digest, error);
	if (status == ESKEL_STORE_OK)
		status = publish(file, error);
	eskel_file_discard(file); /* of the temporary name, which is gone when all went well */
	return status;
}

void eskel_file_discard(eskel_file *file)
{
	if (!file)
		return;
	eskel_folder_remove(file->folder, file->temporary);
	close(file->descriptor);
	free(file);
}

/* ---- reading */

static eskel_store_status damaged(eskel_store_error *error, const eskel_folder *folder, const char *name)
{
	return esk_status_fail(error, ESKEL_STORE_CORRUPT, "the file %s in %s is damaged", name, folder->path);
}

/* The bytes are read once, in pieces; the last 32 are the digest. */
static bool has_its_digest(int descriptor, uint64_t size)
{
	struct sha256_ctx context;
	uint8_t bytes[PIECE], computed[ESK_SHA256_BYTES];
	sha256_init(&context);
	for (uint64_t done = 0; done < size;) {
		const size_t wanted = size - done < PIECE ? (size_t)(size - done) : PIECE;
		const ssize_t read = pread(descriptor, bytes, wanted, (off_t)done);
		if (read <= 0)
			return false;
		sha256_update(&context, (size_t)read, bytes);
		done += (uint64_t)read;
	}
	sha256_digest(&context, sizeof computed, computed);
	return pread(descriptor, bytes, sizeof computed, (off_t)size) == sizeof computed &&
	       memcmp(bytes, computed, sizeof computed) == 0;
}

eskel_store_status eskel_file_open(
	eskel_folder *folder, const char *name, bool verify, int *descriptor, uint64_t *size, eskel_store_error *error)
{
	struct stat is;
	const int opened = openat(folder->directory, name, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
	if (opened < 0 && errno == ENOENT)
		return esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "there is no file %s in %s", name, folder->path);
	if (opened < 0)
		return fail(error, folder, "opened");
	const bool sound = fstat(opened, &is) == 0 && S_ISREG(is.st_mode) && is.st_size >= ESK_SHA256_BYTES;
	const uint64_t bytes = sound ? (uint64_t)is.st_size - ESK_SHA256_BYTES : 0;
	if (!sound || (verify && !has_its_digest(opened, bytes))) {
		close(opened);
		return damaged(error, folder, name);
	}
	*descriptor = opened;
	*size = bytes;
	return ESKEL_STORE_OK;
}
