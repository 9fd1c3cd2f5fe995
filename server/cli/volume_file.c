#include "volume_file.h"

#include "label_names.h"

#include "eskel_dicom.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The labels that --label names, as many as there are options at most. */
static esk_outcome read_labels(const esk_arguments *arguments, int32_t *labels, size_t *count)
{
	size_t position = 0;
	const char *text;
	*count = 0;
	while ((text = esk_arguments_next(arguments, "label", &position))) {
		if (!esk_label_parse(text, &labels[(*count)++]))
			return esk_complain(ESK_MISUSED, "--label is %s, expected a whole number other than 0", text);
	}
	return ESK_DONE;
}

static esk_outcome decode(const char *path, FILE *file, eskel_intake *intake, eskel_volume **volume)
{
	char piece[1 << 16];
	eskel_error error = {0};
	eskel_status status = ESKEL_OK;
	size_t size;
	while (!status && (size = fread(piece, 1, sizeof piece, file)) > 0)
		status = eskel_intake_feed(intake, piece, size, &error);
	if (ferror(file))
		return esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	if (!status)
		status = eskel_intake_finish(intake, volume, &error);
	return status ? esk_complain(ESK_REFUSED, "%s: %s", path, error.text) : ESK_DONE;
}

static esk_outcome check_labels(const char *path, const eskel_volume *volume, const int32_t *labels, size_t count)
{
	unsigned sides;
	for (size_t i = 0; i < count; i++) {
		if (eskel_volume_border(volume, labels[i], &sides))
			return esk_complain(ESK_REFUSED, "%s: no voxel has the label %d", path, (int)labels[i]);
	}
	return ESK_DONE;
}

/* 0, to be chosen, when --spacing was not given. */
static esk_outcome read_spacing(const esk_arguments *arguments, double *spacing)
{
	const char *text = esk_arguments_value(arguments, "spacing");
	char *end;
	if (!text)
		return ESK_DONE;
	*spacing = strtod(text, &end);
	if (end == text || *end || !(*spacing >= 0.001 && *spacing <= 1000))
		return esk_complain(ESK_MISUSED, "--spacing is %s, expected millimetres, 0.001 to 1000", text);
	return ESK_DONE;
}

esk_outcome esk_volume_file_read(const char *path, const esk_arguments *arguments, eskel_volume **volume)
{
	eskel_intake *intake = NULL;
	eskel_volume *made = NULL;
	size_t count = 0;
	double spacing = 0;
	esk_outcome outcome;
	int32_t *labels = calloc(arguments->given_count + 1, sizeof *labels);
	FILE *file = NULL;
	if (!labels)
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	else
		outcome = read_labels(arguments, labels, &count);
	if (!outcome)
		outcome = read_spacing(arguments, &spacing);
	if (!outcome && !(file = fopen(path, "re")))
		outcome = esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	const eskel_volume_options options = {.labels = count > 0 ? labels : NULL,
		.label_count = count,
		.weights = esk_arguments_value(arguments, "weights"),
		.spacing = spacing};
	if (!outcome && eskel_intake_new(&options, NULL, &intake))
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	if (!outcome)
		outcome = decode(path, file, intake, &made);
	if (!outcome)
		outcome = check_labels(path, made, labels, count);
	if (file)
		fclose(file);
	eskel_intake_free(intake);
	free(labels);
	if (outcome)
		eskel_volume_free(made);
	else
		*volume = made;
	return outcome;
}
