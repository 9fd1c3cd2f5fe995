/* A file is an image in memory, shared by all connections, and the real file under it. In the power loss modes the
 * image is the operating system's page cache: it holds what was written, the real file what has reached the disk. A block
 * that was written can reach the disk early, in any order and without its neighbours, as after a real loss of power. */
#include "fault_vfs.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { block_size = 4096, early_one_in = 8 };

typedef struct image {
	char *path;
	uint8_t *bytes;
	bool *dirty; /* one a block */
	sqlite3_int64 size, capacity;
	struct image *next;
} image;

typedef struct {
	sqlite3_file base;
	image *image;
	int kind; /* SQLITE_OPEN_MAIN_DB and so on */
	sqlite3_file *real;
} fault_file;

static struct {
	pthread_mutex_t mutex;
	fault_vfs_mode mode;
	sqlite3_vfs *real;
	image *images;
	uint32_t random;
	fault_vfs_operation operation;
	int file, countdown, result, failed;
} shared = {.mutex = PTHREAD_MUTEX_INITIALIZER};

static void *demand(void *memory)
{
	if (!memory) {
		fprintf(stderr, "memory ran out in the test's VFS\n");
		abort();
	}
	return memory;
}

/* ------------------------------------------------------------------------------------------------ faults */

void fault_vfs_fail(fault_vfs_operation operation, int file, int nth, int result)
{
	pthread_mutex_lock(&shared.mutex);
	shared.operation = operation;
	shared.file = file;
	shared.countdown = nth;
	shared.result = result;
	shared.failed = 0;
	pthread_mutex_unlock(&shared.mutex);
}

int fault_vfs_heal(void)
{
	pthread_mutex_lock(&shared.mutex);
	int failed = shared.failed;
	shared.file = shared.failed = 0;
	pthread_mutex_unlock(&shared.mutex);
	return failed;
}

static int fault(const fault_file *f, fault_vfs_operation operation)
{
	if (!(f->kind & shared.file) || operation != shared.operation)
		return SQLITE_OK;
	if (shared.countdown > 1) {
		shared.countdown--;
		return SQLITE_OK;
	}
	shared.failed++;
	return shared.result;
}

/* ------------------------------------------------------------------------------------------------ images */

static image *find_image(const char *path)
{
	for (image *i = shared.images; i; i = i->next)
		if (strcmp(i->path, path) == 0)
			return i;
	return NULL;
}

static void reserve(image *i, sqlite3_int64 size)
{
	if (size <= i->capacity)
		return;
	sqlite3_int64 capacity = (2 * size + block_size - 1) / block_size * block_size;
	i->bytes = demand(realloc(i->bytes, (size_t)capacity));
	i->dirty = demand(realloc(i->dirty, (size_t)(capacity / block_size)));
	memset(i->bytes + i->capacity, 0, (size_t)(capacity - i->capacity));
	memset(i->dirty + i->capacity / block_size, 0, (size_t)((capacity - i->capacity) / block_size));
	i->capacity = capacity;
}

static image *load_image(const char *path, sqlite3_file *real)
{
	image *i = demand(calloc(1, sizeof *i));
	i->path = demand(strdup(path));
	real->pMethods->xFileSize(real, &i->size);
	reserve(i, i->size);
	if (i->size)
		real->pMethods->xRead(real, i->bytes, (int)i->size, 0);
	i->next = shared.images;
	shared.images = i;
	return i;
}

static void drop_image(const char *path)
{
	for (image **i = &shared.images; *i; i = &(*i)->next) {
		if (strcmp((*i)->path, path) != 0)
			continue;
		image *gone = *i;
		*i = gone->next;
		free(gone->path);
		free(gone->bytes);
		free(gone->dirty);
		free(gone);
		return;
	}
}

static int write_block(fault_file *f, sqlite3_int64 block)
{
	sqlite3_int64 offset = block * block_size, rest = f->image->size - offset;
	if (rest <= 0)
		return SQLITE_OK;
	return f->real->pMethods->xWrite(
		f->real, f->image->bytes + offset, rest < block_size ? (int)rest : block_size, offset);
}

static bool goes_early(void)
{
	shared.random = shared.random * 1664525u + 1013904223u;
	return (shared.random >> 16) % early_one_in == 0;
}

static int write_image(fault_file *f, const void *bytes, int size, sqlite3_int64 offset)
{
	image *i = f->image;
	reserve(i, offset + size);
	memcpy(i->bytes + offset, bytes, (size_t)size);
	if (i->size < offset + size)
		i->size = offset + size;
	for (sqlite3_int64 block = offset / block_size; block <= (offset + size - 1) / block_size; block++) {
		i->dirty[block] = true;
		if (goes_early() && write_block(f, block) != SQLITE_OK)
			return SQLITE_IOERR_WRITE;
	}
	return SQLITE_OK;
}

static int sync_image(fault_file *f)
{
	image *i = f->image;
	sqlite3_int64 on_disk = 0;
	int result = f->real->pMethods->xFileSize(f->real, &on_disk);
	if (result == SQLITE_OK && on_disk > i->size)
		result = f->real->pMethods->xTruncate(f->real, i->size);
	for (sqlite3_int64 block = 0; block < i->capacity / block_size && result == SQLITE_OK; block++) {
		if (i->dirty[block])
			result = write_block(f, block);
		i->dirty[block] = false;
	}
	return result;
}

/* ------------------------------------------------------------------------------------------------ file methods */

static int file_close(sqlite3_file *file)
{
	fault_file *f = (fault_file *)file;
	int result = f->real->pMethods->xClose(f->real);
	free(f->real);
	return result;
}

static int read_image(const image *i, void *bytes, int size, sqlite3_int64 offset)
{
	sqlite3_int64 there = offset < i->size ? i->size - offset : 0;
	size_t copied = (size_t)(there < size ? there : size);
	memset(bytes, 0, (size_t)size);
	if (copied)
		memcpy(bytes, i->bytes + offset, copied);
	return copied == (size_t)size ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

static int file_read(sqlite3_file *file, void *bytes, int size, sqlite3_int64 offset)
{
	fault_file *f = (fault_file *)file;
	pthread_mutex_lock(&shared.mutex);
	int result = fault(f, FAULT_VFS_READ);
	if (result == SQLITE_OK && f->image)
		result = read_image(f->image, bytes, size, offset);
	else if (result == SQLITE_OK)
		result = f->real->pMethods->xRead(f->real, bytes, size, offset);
	pthread_mutex_unlock(&shared.mutex);
	return result;
}

static int file_write(sqlite3_file *file, const void *bytes, int size, sqlite3_int64 offset)
{
	fault_file *f = (fault_file *)file;
	pthread_mutex_lock(&shared.mutex);
	int result = fault(f, FAULT_VFS_WRITE);
	if (result == SQLITE_OK && f->image)
		result = write_image(f, bytes, size, offset);
	else if (result == SQLITE_OK)
		result = f->real->pMethods->xWrite(f->real, bytes, size, offset);
	pthread_mutex_unlock(&shared.mutex);
	return result;
}

static int file_truncate(sqlite3_file *file, sqlite3_int64 size)
{
	fault_file *f = (fault_file *)file;
	if (!f->image)
		return f->real->pMethods->xTruncate(f->real, size);
	pthread_mutex_lock(&shared.mutex);
	if (size < f->image->size) {
		memset(f->image->bytes + size, 0, (size_t)(f->image->size - size));
		f->image->size = size;
	}
	pthread_mutex_unlock(&shared.mutex);
	return SQLITE_OK;
}

static int file_sync(sqlite3_file *file, int flags)
{
	fault_file *f = (fault_file *)file;
	pthread_mutex_lock(&shared.mutex);
	int result = fault(f, FAULT_VFS_SYNC);
	if (result == SQLITE_OK && shared.mode == FAULT_VFS_POWER_LOSS && f->image)
		result = sync_image(f);
	else if (result == SQLITE_OK && !f->image)
		result = f->real->pMethods->xSync(f->real, flags);
	pthread_mutex_unlock(&shared.mutex);
	return result;
}

static int file_size(sqlite3_file *file, sqlite3_int64 *size)
{
	fault_file *f = (fault_file *)file;
	if (!f->image)
		return f->real->pMethods->xFileSize(f->real, size);
	pthread_mutex_lock(&shared.mutex);
	*size = f->image->size;
	pthread_mutex_unlock(&shared.mutex);
	return SQLITE_OK;
}

static int file_lock(sqlite3_file *file, int level)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xLock(f->real, level);
}

static int file_unlock(sqlite3_file *file, int level)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xUnlock(f->real, level);
}

static int file_check_lock(sqlite3_file *file, int *held)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xCheckReservedLock(f->real, held);
}

/* A size hint would lengthen the real file behind the image. */
static int file_control(sqlite3_file *file, int operation, void *argument)
{
	fault_file *f = (fault_file *)file;
	if (operation == SQLITE_FCNTL_SIZE_HINT)
		return SQLITE_OK;
	return f->real->pMethods->xFileControl(f->real, operation, argument);
}

static int file_sector_size(sqlite3_file *file)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xSectorSize(f->real);
}

static int file_characteristics(sqlite3_file *file)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xDeviceCharacteristics(f->real);
}

static int file_map(sqlite3_file *file, int region, int size, int extend, void volatile **memory)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xShmMap(f->real, region, size, extend, memory);
}

static int file_lock_map(sqlite3_file *file, int offset, int count, int flags)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xShmLock(f->real, offset, count, flags);
}

static void file_barrier(sqlite3_file *file)
{
	fault_file *f = (fault_file *)file;
	f->real->pMethods->xShmBarrier(f->real);
}

static int file_unmap(sqlite3_file *file, int remove)
{
	fault_file *f = (fault_file *)file;
	return f->real->pMethods->xShmUnmap(f->real, remove);
}

static const sqlite3_io_methods methods = {
	.iVersion = 2,
	.xClose = file_close,
	.xRead = file_read,
	.xWrite = file_write,
	.xTruncate = file_truncate,
	.xSync = file_sync,
	.xFileSize = file_size,
	.xLock = file_lock,
	.xUnlock = file_unlock,
	.xCheckReservedLock = file_check_lock,
	.xFileControl = file_control,
	.xSectorSize = file_sector_size,
	.xDeviceCharacteristics = file_characteristics,
	.xShmMap = file_map,
	.xShmLock = file_lock_map,
	.xShmBarrier = file_barrier,
	.xShmUnmap = file_unmap,
};

/* ------------------------------------------------------------------------------------------------ vfs methods */

static int vfs_open(sqlite3_vfs *vfs, sqlite3_filename name, sqlite3_file *file, int flags, int *flags_out)
{
	(void)vfs;
	fault_file *f = (fault_file *)file;
	memset(f, 0, sizeof *f);
	f->kind = flags & (SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL);
	f->real = calloc(1, (size_t)shared.real->szOsFile);
	if (!f->real)
		return SQLITE_NOMEM;
	int result = shared.real->xOpen(shared.real, name, f->real, flags, flags_out);
	if (result != SQLITE_OK) {
		free(f->real);
		return result;
	}
	if (shared.mode != FAULT_VFS_PASS && f->kind) {
		pthread_mutex_lock(&shared.mutex);
		f->image = find_image(name);
		if (!f->image)
			f->image = load_image(name, f->real);
		pthread_mutex_unlock(&shared.mutex);
	}
	f->base.pMethods = &methods;
	return SQLITE_OK;
}

static int vfs_delete(sqlite3_vfs *vfs, const char *name, int sync_folder)
{
	(void)vfs;
	pthread_mutex_lock(&shared.mutex);
	drop_image(name);
	pthread_mutex_unlock(&shared.mutex);
	return shared.real->xDelete(shared.real, name, sync_folder);
}

void fault_vfs_install(fault_vfs_mode mode)
{
	static sqlite3_vfs vfs;
	shared.mode = mode;
	shared.real = sqlite3_vfs_find(NULL);
	shared.real->xRandomness(shared.real, sizeof shared.random, (char *)&shared.random);
	vfs = *shared.real;
	vfs.zName = "fault";
	vfs.szOsFile = (int)sizeof(fault_file);
	vfs.xOpen = vfs_open;
	vfs.xDelete = vfs_delete;
	sqlite3_vfs_register(&vfs, 1);
}
