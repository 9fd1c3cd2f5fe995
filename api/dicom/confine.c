/* The list of system calls is what the C library and its loader make of a program that reads, computes and writes. All
 * others fail as if the kernel had none of that name, so that a library takes the way round that it knows. */
#include "confine.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { nobody = 65534 };

/* ---- limits */

static bool limit(unsigned resource, rlim_t most)
{
	return setrlimit(resource, &(struct rlimit){most, most}) == 0;
}

/* What sets the user id may be refused where a limit of processes is exceeded, so that limit is the last. */
static bool limit_resources(void)
{
	return limit(RLIMIT_CPU, 60) && limit(RLIMIT_FSIZE, 0) && limit(RLIMIT_NOFILE, 32) && limit(RLIMIT_CORE, 0);
}

static bool drop_rights(void)
{
	if (geteuid() == 0 &&
		(setgroups(0, NULL) || setresgid(nobody, nobody, nobody) || setresuid(nobody, nobody, nobody)))
		return false;
	/* Who gets another user id forgets to end with its parent. */
	return limit(RLIMIT_NPROC, 0) && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
	       prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0) == 0;
}

/* ---- files */

static const uint64_t reading = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE;

static bool allow(int rules, const char *path, uint64_t access)
{
	struct landlock_path_beneath_attr rule = {
		.allowed_access = access, .parent_fd = open(path, O_PATH | O_CLOEXEC)};
	if (rule.parent_fd < 0)
		return errno == ENOENT;
	const bool good = syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
	close(rule.parent_fd);
	return good;
}

/* /lib and so on are links to folders in /usr, or hold the same. */
static bool confine_files(const char *program)
{
	static const char *const folders[] = {"/usr", "/lib", "/lib64"};
	const struct landlock_ruleset_attr all = {.handled_access_fs = LANDLOCK_ACCESS_FS_MAKE_SYM * 2 - 1};
	const int rules = (int)syscall(SYS_landlock_create_ruleset, &all, sizeof all, 0);
	if (rules < 0)
		return errno == ENOSYS || errno == EOPNOTSUPP ||
		       errno == EPERM; /* too old, switched off or kept away */
	bool good = allow(rules, program, reading) && allow(rules, "/etc/ld.so.cache", LANDLOCK_ACCESS_FS_READ_FILE);
	for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
		good = good && allow(rules, folders[i], reading | LANDLOCK_ACCESS_FS_READ_DIR);
	good = good && syscall(SYS_landlock_restrict_self, rules, 0) == 0;
	close(rules);
	return good;
}

/* ---- system calls */

#if defined __x86_64__
#define ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined __aarch64__
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

static const unsigned short calls[] = {
#ifdef SYS_open
	SYS_access, SYS_arch_prctl, SYS_open, SYS_readlink, SYS_stat,
#endif
	SYS_brk, SYS_clock_gettime, SYS_clock_nanosleep, SYS_close, SYS_dup, SYS_execve, SYS_exit, SYS_exit_group,
	SYS_faccessat, SYS_faccessat2, SYS_fcntl, SYS_fstat, SYS_futex, SYS_getcwd, SYS_getdents64, SYS_getegid,
	SYS_geteuid, SYS_getgid, SYS_getpid, SYS_getrandom, SYS_gettid, SYS_getuid, SYS_ioctl, SYS_lseek, SYS_madvise,
	SYS_mmap, SYS_mprotect, SYS_mremap, SYS_munmap, SYS_newfstatat, SYS_openat, SYS_pread64, SYS_read,
	SYS_readlinkat, SYS_readv, SYS_rseq, SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn,
	SYS_sched_getaffinity, SYS_sched_yield, SYS_set_robust_list, SYS_set_tid_address, SYS_sigaltstack, SYS_statx,
	SYS_sysinfo, SYS_uname, SYS_write, SYS_writev};

enum { CALLS = sizeof calls / sizeof *calls };

/* Loads the architecture, then the number, and compares it with one after another; a jump counts the statements that
 * it leaves out. A number of the x32 interface is none of the list. */
static bool confine_calls(void)
{
#ifdef ARCHITECTURE
	enum { head = 3 };
	struct sock_filter program[head + CALLS + 2];
	program[0] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch));
	program[1] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 0, CALLS + 1);
	program[2] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
	for (unsigned i = 0; i < CALLS; i++)
		program[head + i] = (struct sock_filter)BPF_JUMP(
			BPF_JMP | BPF_JEQ | BPF_K, calls[i], (unsigned char)(CALLS - i), 0);
	program[head + CALLS] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS);
	program[head + CALLS + 1] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
	const struct sock_fprog filter = {head + CALLS + 2, program};
	return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0) == 0 || errno == EINVAL;
#else
	return true;
#endif
}

bool esk_confine(const char *program)
{
	/* The process may have more memory than the program is to have, and can then get none: so late. */
	return limit_resources() && drop_rights() && confine_files(program) && limit(RLIMIT_AS, (rlim_t)2 << 30) &&
	       confine_calls();
}
