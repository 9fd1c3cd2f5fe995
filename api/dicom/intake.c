/* The first 132 bytes of a file decide; DICOM has "DICM" at their end (PS3.10, section 7.1). Of a gzipped file a kilobyte is
 * taken, which tells them whatever the name in its header. gzip, confined as dcmdrle is, gives the rest. */
#include "eskel_dicom.h"

#include "data_set.h"
#include "refusal.h"
#include "tool.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { preamble = 128, head_size = preamble + 4, gzip_first_byte = 0x1f, gzip_head_size = 1024 };

/* As much of the disk as gzipped DICOM may take; gzip inflates as much of nothing in less than two seconds. */
static const uint64_t most_inflated = (uint64_t)1 << 28;

struct eskel_intake {
	eskel_volume *volume;
	const char *tool;
	eskel_error error; /* of DICOM; status other than ESKEL_OK: every further call returns it */
	uint8_t head[gzip_head_size];
	size_t head_used;
	FILE *dicom; /* NULL: none, or not yet known */
	bool gzipped;
};

eskel_status eskel_intake_new(const eskel_volume_options *options, const char *tool, eskel_intake **intake)
{
	eskel_intake *made = calloc(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	made->tool = tool ? tool : "/usr/bin/dcmdrle";
	eskel_status status = eskel_volume_new(options, &made->volume);
	if (status == ESKEL_OK)
		*intake = made;
	else
		eskel_intake_free(made);
	return status;
}

void eskel_intake_free(eskel_intake *intake)
{
	if (!intake)
		return;
	if (intake->dicom)
		fclose(intake->dicom);
	eskel_volume_free(intake->volume);
	free(intake);
}

static eskel_status report(const eskel_intake *intake, eskel_error *error)
{
	if (intake->error.status != ESKEL_OK && error)
		*error = intake->error;
	return intake->error.status;
}

/* ---- bytes */

static eskel_status refuse_file(eskel_intake *intake)
{
	return esk_refuse(&intake->error, ESKEL_NO_MEMORY, "a temporary file for DICOM failed: %s", strerror(errno));
}

static void keep(eskel_intake *intake, const uint8_t *bytes, size_t size)
{
	if (intake->error.status == ESKEL_OK && fwrite(bytes, 1, size, intake->dicom) != size)
		refuse_file(intake);
}

static size_t head_needed(const eskel_intake *intake)
{
	return intake->gzipped ? gzip_head_size : head_size;
}

static bool is_dicom(const eskel_intake *intake)
{
	uint8_t inflated[head_size];
	const uint8_t *head = intake->gzipped ? inflated : intake->head;
	const size_t size = intake->gzipped ? eskel_gzip_begin(intake->head, intake->head_used, inflated, head_size)
					    : intake->head_used;
	return size >= head_size && memcmp(head + preamble, "DICM", 4) == 0;
}

/* The head is whole, or all there is. */
static eskel_status decide(eskel_intake *intake, eskel_error *error)
{
	if (!is_dicom(intake))
		return eskel_volume_feed(intake->volume, intake->head, intake->head_used, error);
	intake->dicom = tmpfile();
	if (!intake->dicom)
		refuse_file(intake);
	keep(intake, intake->head, intake->head_used);
	return report(intake, error);
}

eskel_status eskel_intake_feed(eskel_intake *intake, const void *bytes, size_t size, eskel_error *error)
{
	const uint8_t *from = bytes;
	if (intake->error.status != ESKEL_OK || size == 0)
		return report(intake, error);
	if (intake->head_used == 0)
		intake->gzipped = from[0] == gzip_first_byte;
	const bool decided = intake->head_used == head_needed(intake);
	const size_t missing = head_needed(intake) - intake->head_used, taken = size < missing ? size : missing;
	memcpy(intake->head + intake->head_used, from, taken);
	intake->head_used += taken;
	if (intake->head_used < head_needed(intake))
		return ESKEL_OK;
	eskel_status status = decided ? ESKEL_OK : decide(intake, error);
	if (status != ESKEL_OK || size == taken)
		return status;
	if (!intake->dicom)
		return eskel_volume_feed(intake->volume, from + taken, size - taken, error);
	keep(intake, from + taken, size - taken);
	return report(intake, error);
}

/* ---- the end */

static eskel_status copy(esk_tool *tool, FILE *to, eskel_error *error)
{
	uint8_t bytes[1 << 16];
	uint64_t all = 0;
	size_t got;
	do {
		eskel_status status = esk_tool_read(tool, bytes, sizeof bytes, &got, error);
		if (status != ESKEL_OK)
			return status;
		all += got;
		if (all > most_inflated)
			return esk_refuse(error, ESKEL_TOO_LARGE,
				"the DICOM file is gzipped and has more than %llu bytes, expected it without gzip",
				(unsigned long long)most_inflated);
		if (fwrite(bytes, 1, got, to) != got)
			return esk_refuse(
				error, ESKEL_NO_MEMORY, "a temporary file for DICOM failed: %s", strerror(errno));
	} while (got > 0);
	return ESKEL_OK;
}

/* What the file holds takes its place. */
static eskel_status gunzip(eskel_intake *intake, eskel_error *error)
{
	static const char *const arguments[] = {"gzip", "-dc", NULL};
	esk_tool tool;
	FILE *inflated = tmpfile();
	if (!inflated)
		return refuse_file(intake);
	eskel_status status = esk_tool_start("/usr/bin/gzip", arguments, fileno(intake->dicom), &tool, error);
	if (status == ESKEL_OK) {
		status = copy(&tool, inflated, error);
		esk_tool_end(&tool);
	}
	if (status == ESKEL_OK && fflush(inflated) != 0)
		status = refuse_file(intake);
	fclose(intake->dicom);
	intake->dicom = inflated;
	return status;
}

static eskel_status decode(eskel_intake *intake, eskel_error *error)
{
	/* From standard input to standard output, without the head of a file. */
	static const char *const arguments[] = {"dcmdrle", "--write-dataset", "-", "-", NULL};
	esk_tool tool;
	eskel_status status = esk_tool_start(intake->tool, arguments, fileno(intake->dicom), &tool, error);
	if (status != ESKEL_OK)
		return status;
	status = esk_data_set_read(esk_tool_read, &tool, intake->volume, error);
	esk_tool_end(&tool);
	return status;
}

eskel_status eskel_intake_finish(eskel_intake *intake, eskel_volume **volume, eskel_error *error)
{
	eskel_status status = report(intake, error);
	if (status == ESKEL_OK && intake->head_used > 0 && intake->head_used < head_needed(intake))
		status = decide(intake, error);
	if (status == ESKEL_OK && intake->dicom) {
		status = fflush(intake->dicom) == 0 ? ESKEL_OK : refuse_file(intake);
		if (status == ESKEL_OK && intake->gzipped)
			status = gunzip(intake, &intake->error);
		if (status == ESKEL_OK)
			status = decode(intake, &intake->error);
		report(intake, error);
	}
	if (status == ESKEL_OK)
		status = eskel_volume_finish(intake->volume, error);
	if (status == ESKEL_OK) {
		*volume = intake->volume;
		intake->volume = NULL;
	}
	return status;
}
