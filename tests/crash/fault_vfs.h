/* An SQLite VFS in front of the default one, for disks that fail: one operation can be made to fail, or all writes can
 * be kept in memory until they are synced, so that the death of the process is a loss of power. */
#ifndef FAULT_VFS_H
#define FAULT_VFS_H

#include <sqlite3.h>

typedef enum {
	FAULT_VFS_PASS,       /* writes go to the file at once */
	FAULT_VFS_POWER_LOSS, /* blocks stay in memory until xSync, but for some that the disk takes early */
	FAULT_VFS_LYING_DISK, /* the same, and xSync does nothing: what a test of power loss must notice */
} fault_vfs_mode;

/* Registers it as the default. Once in a process, before the first connection. */
void fault_vfs_install(fault_vfs_mode mode);

typedef enum { FAULT_VFS_READ, FAULT_VFS_WRITE, FAULT_VFS_SYNC } fault_vfs_operation;

/* From the nth operation on (1: the next) every one on such a file (SQLITE_OPEN_MAIN_DB, SQLITE_OPEN_WAL) fails with
 * result, until fault_vfs_heal. */
void fault_vfs_fail(fault_vfs_operation operation, int file, int nth, int result);
/* Returns how many have failed. */
int fault_vfs_heal(void);

#endif
