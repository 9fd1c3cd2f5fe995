/* Takes from a process what a filter program does not need. */
#ifndef ESK_CONFINE_H
#define ESK_CONFINE_H

#include <stdbool.h>

/* For the child of a fork, before it executes program; calls only what is safe there. From then on, also for that
 * program, it
 *   - has no rights of root, and cannot win any;
 *   - is killed when the thread that forked ends;
 *   - has 2 GiB of memory, a minute of a processor, 32 open files, and writes to no file that is not open;
 *   - starts no process or thread, and has no system calls but those that a filter needs: no socket, no signal;
 *   - sees of the file system what lies in /usr, the loader's cache, and program.
 * The last two hold where the kernel can do it (seccomp; Landlock, Linux 5.13), which it need not. False when something
 * else failed. */
bool esk_confine(const char *program);

#endif
