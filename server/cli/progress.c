#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { bar_width = 20, name_width = 32 };
static const double redraw_seconds = 0.1, line_seconds = 10;

static double seconds_since(const struct timespec *then)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)(now.tv_sec - then->tv_sec) + 1e-9 * (double)(now.tv_nsec - then->tv_nsec);
}

/* At most limit bytes of text, no UTF-8 character cut. */
static int whole_characters(const char *text, size_t limit)
{
	size_t length = strnlen(text, limit + 1);
	if (length > limit)
		for (length = limit; length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80; length--)
			;
	return (int)length;
}

static size_t terminal_width(void)
{
	struct winsize size;
	return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/* "[#####...............] 12 of 78  femur.nii.gz  what it does" over the line before, not past the terminal's edge. */
static void draw(esk_progress *progress, double fraction, const char *doing)
{
	char bar[bar_width + 1], line[256];
	double whole = ((double)progress->item - 1 + fraction) / (double)progress->items;
	int filled = whole < 1 ? (int)(whole * bar_width) : bar_width;
	memset(bar, '.', bar_width);
	memset(bar, '#', (size_t)filled);
	bar[bar_width] = '\0';
	const char *name = basename(progress->name);
	snprintf(line, sizeof line, "[%s] %zu of %zu  %.*s  %s", bar, progress->item, progress->items,
		whole_characters(name, name_width), name, doing);
	fprintf(stderr, "\r%.*s\033[K", whole_characters(line, terminal_width() - 1), line);
	clock_gettime(CLOCK_MONOTONIC, &progress->drawn);
}

static bool wants_drawing(const esk_progress *progress)
{
	return !progress->quiet && progress->terminal && seconds_since(&progress->drawn) >= redraw_seconds;
}

void esk_progress_begin(esk_progress *progress, bool quiet, size_t items)
{
	*progress = (esk_progress){.quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1, .items = items};
}

void esk_progress_next(esk_progress *progress, const char *name)
{
	if (progress->item < progress->items)
		progress->item++;
	progress->name = name;
	clock_gettime(CLOCK_MONOTONIC, &progress->started);
}

void esk_progress_sent(esk_progress *progress, uint64_t sent, uint64_t total)
{
	if (!wants_drawing(progress))
		return;
	char doing[64];
	if (sent < total)
		snprintf(doing, sizeof doing, "sending %.1f of %.1f MB", 1e-6 * (double)sent, 1e-6 * (double)total);
	else
		snprintf(doing, sizeof doing, "%s %.0f s", total > 0 ? "computing" : "waiting",
			seconds_since(&progress->started));
	draw(progress, total > 0 ? (double)sent / (double)total : 0, doing);
}

/* "3.1 a second, 20 s left" */
static void describe_rate(char *text, size_t size, double rate, double seconds_left)
{
	const bool minutes = seconds_left >= 100;
	snprintf(text, size, "%.3g a second, %.0f %s left", rate, minutes ? seconds_left / 60 : seconds_left,
		minutes ? "min" : "s");
}

void esk_progress_received(esk_progress *progress, uint64_t rows, uint64_t total)
{
	if (!wants_drawing(progress) || rows == 0 || total == 0)
		return;
	char doing[128], pace[64];
	const double rate = (double)rows / seconds_since(&progress->started);
	describe_rate(pace, sizeof pace, rate, rows < total ? (double)(total - rows) / rate : 0);
	snprintf(doing, sizeof doing, "%llu of %llu rows, %s", (unsigned long long)rows, (unsigned long long)total,
		pace);
	draw(progress, (double)rows / (double)total, doing);
}

void esk_progress_computed(esk_progress *progress, uint32_t steps, uint32_t total)
{
	if (!wants_drawing(progress))
		return;
	char doing[64];
	snprintf(doing, sizeof doing, "level %u of %u", steps, total);
	draw(progress, total > 0 ? (double)steps / (double)total : 0, doing);
}

void esk_progress_counted(esk_progress *progress, size_t done, double share)
{
	const double seconds = seconds_since(&progress->started);
	const double interval = progress->terminal ? redraw_seconds : line_seconds;
	if (progress->quiet || done == 0 || share <= 0 || seconds < interval ||
		seconds_since(&progress->drawn) < interval)
		return;
	char doing[96];
	describe_rate(doing, sizeof doing, (double)done / seconds, seconds * (1 - share) / share);
	if (progress->terminal) {
		progress->item = done;
		draw(progress, 1, doing);
		return;
	}
	fprintf(stderr, "%zu of %zu %s, %s\n", done, progress->items, progress->name, doing);
	clock_gettime(CLOCK_MONOTONIC, &progress->drawn);
}

void esk_progress_worked(esk_progress *progress, double share, double seconds)
{
	if (!wants_drawing(progress))
		return;
	char doing[64];
	snprintf(doing, sizeof doing, "%.1f %%, %.0f s", 100 * share, seconds);
	draw(progress, share, doing);
}

void esk_progress_end(esk_progress *progress, bool done)
{
	if (progress->quiet)
		return;
	if (progress->terminal)
		fputs("\r\033[K", stderr);
	else if (done && progress->items > 1)
		fprintf(stderr, "%zu of %zu: %s, %.1f s\n", progress->item, progress->items, progress->name,
			seconds_since(&progress->started));
}
