#include "tool.h"

#include "confine.h"
#include "refusal.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <unistd.h>

/* A gigabyte takes dcmdrle three seconds. */
enum { seconds = 60 };

/* ---- the child */

/* What was ignored or blocked stays so in the program; SIGPIPE is, in the daemon. */
static void reset_signals(void)
{
	sigset_t none;
	sigemptyset(&none);
	signal(SIGPIPE, SIG_DFL);
	sigprocmask(SIG_SETMASK, &none, NULL);
}

/* The file, the pipe and nothing as descriptors 0, 1 and 2, and no others. */
static bool set_descriptors(int file, int output)
{
	const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
	return nothing > 2 && lseek(file, 0, SEEK_SET) == 0 && dup2(file, 0) == 0 && dup2(output, 1) == 1 &&
	       dup2(nothing, 2) == 2 && close_range(3, ~0u, 0) == 0;
}

static void run(const char *program, const char *const *arguments, int file, int output) __attribute__((noreturn));

static void run(const char *program, const char *const *arguments, int file, int output)
{
	char *const nothing[] = {NULL};
	setpgid(0, 0);
	reset_signals();
	if (set_descriptors(file, output) && chdir("/") == 0 && esk_confine(program))
		execve(program, (char *const *)arguments, nothing);
	_exit(127);
}

/* ---- the parent */

static void end_process(pid_t process)
{
	if (process <= 0)
		return;
	kill(process, SIGKILL);
	waitpid(process, NULL, 0);
}

static eskel_status start(const char *program, const char *const *arguments, int file, const int pipe_ends[2],
	esk_tool *tool, eskel_error *error)
{
	const pid_t process = fork();
	if (process == 0)
		run(program, arguments, file, pipe_ends[1]);
	const int ending = process > 0 ? pidfd_open(process, 0) : -1;
	if (ending < 0) {
		esk_refuse(error, ESKEL_NO_MEMORY, "%s could not be started: %s", program, strerror(errno));
		end_process(process);
		return ESKEL_NO_MEMORY;
	}
	setpgid(process, process);
	*tool = (esk_tool){.program = program, .process = process, .ending = ending, .output = pipe_ends[0]};
	clock_gettime(CLOCK_MONOTONIC, &tool->deadline);
	tool->deadline.tv_sec += seconds;
	return ESKEL_OK;
}

eskel_status esk_tool_start(
	const char *program, const char *const *arguments, int file, esk_tool *tool, eskel_error *error)
{
	int pipe_ends[2];
	if (access(program, X_OK) != 0)
		return esk_refuse(error, ESKEL_UNSUPPORTED,
			"DICOM is decoded by %s, which is not there: install the Debian package dcmtk", program);
	if (pipe2(pipe_ends, O_CLOEXEC) != 0)
		return esk_refuse(error, ESKEL_NO_MEMORY, "%s could not be started: %s", program, strerror(errno));
	eskel_status status = start(program, arguments, file, pipe_ends, tool, error);
	close(pipe_ends[1]);
	if (status != ESKEL_OK)
		close(pipe_ends[0]);
	return status;
}

/* 0 when it is past. */
static int milliseconds_left(const esk_tool *tool)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	const int64_t left =
		(int64_t)(tool->deadline.tv_sec - now.tv_sec) * 1000 + (tool->deadline.tv_nsec - now.tv_nsec) / 1000000;
	return left > 0 ? (int)left : 0;
}

/* Until there is something to read from the descriptor; false when the time is over. */
static bool await(const esk_tool *tool, int descriptor)
{
	int ready;
	do {
		struct pollfd wanted = {.fd = descriptor, .events = POLLIN};
		ready = poll(&wanted, 1, milliseconds_left(tool));
	} while (ready < 0 && errno == EINTR);
	return ready > 0;
}

static eskel_status refuse_late(esk_tool *tool, eskel_error *error)
{
	return esk_refuse(error, ESKEL_TOO_LARGE, "%s took longer than %d s to decode the DICOM file", tool->program,
		(int)seconds);
}

/* The pipe's end is reached: the program has ended, or will soon. */
static eskel_status await_end(esk_tool *tool, eskel_error *error)
{
	int how = 0;
	if (!await(tool, tool->ending))
		return refuse_late(tool, error);
	if (waitpid(tool->process, &how, 0) != tool->process)
		how = 1;
	tool->process = 0;
	if (how != 0 && milliseconds_left(tool) == 0) /* the minute of a processor (confine.h) is over no sooner */
		return refuse_late(tool, error);
	return how == 0 ? ESKEL_OK
			: esk_refuse(error, ESKEL_MALFORMED,
				  "%s could not decode the DICOM file: it is damaged, needs more than 2 GiB of "
				  "memory, or is compressed other than by deflation, or by run lengths of whole bytes, "
				  "which dcmdjpeg or dcmdjpls of DCMTK may undo",
				  tool->program);
}

eskel_status esk_tool_read(void *source, uint8_t *bytes, size_t most, size_t *got, eskel_error *error)
{
	esk_tool *tool = source;
	ssize_t size;
	do {
		if (!await(tool, tool->output))
			return refuse_late(tool, error);
		size = read(tool->output, bytes, most);
	} while (size < 0 && errno == EINTR);
	*got = size > 0 ? (size_t)size : 0;
	return size > 0 || tool->process == 0 ? ESKEL_OK : await_end(tool, error);
}

void esk_tool_end(esk_tool *tool)
{
	end_process(tool->process);
	close(tool->ending);
	close(tool->output);
}
