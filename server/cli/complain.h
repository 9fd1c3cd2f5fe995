/* How a command of eskel ends, and what it says when it does not end well. */
#ifndef ESK_COMPLAIN_H
#define ESK_COMPLAIN_H

/* The exit codes, the worst last: a command on many files ends with the worst of theirs. */
typedef enum {
	ESK_DONE,
	ESK_REFUSED,    /* by the server, or by the engine without one; or not recognised */
	ESK_MISUSED,    /* wrong options, a file that cannot be read, a wrong table of labels */
	ESK_UNREACHABLE /* no server, no answer, or an answer that is none of eskel's */
} esk_outcome;

/* One line on standard error; returns the outcome, so that a function can end with it. */
esk_outcome esk_complain(esk_outcome outcome, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
