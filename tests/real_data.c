#include "real_data.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIECE = 1 << 16, SET_MAX = 256, LINE_MAX_SIZE = 512 };

__attribute__((format(printf, 1, 2), noreturn)) static void give_up(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	vfprintf(stderr, format, arguments);
	va_end(arguments);
	fputc('\n', stderr);
	exit(1);
}

static FILE *open_file(const char *path)
{
	FILE *file = fopen(path, "rb");
	if (!file)
		give_up("%s cannot be opened", path);
	return file;
}

bool real_file_exists(const char *path)
{
	FILE *file = fopen(path, "rb");
	if (file)
		fclose(file);
	return file != NULL;
}

eskel_volume *real_volume(const char *path)
{
	static uint8_t bytes[PIECE];
	eskel_volume *volume = NULL;
	eskel_error error = {.text = "memory ran out"};
	FILE *file = open_file(path);
	eskel_status status = eskel_volume_new(NULL, &volume);
	for (size_t size; status == ESKEL_OK && (size = fread(bytes, 1, sizeof bytes, file)) > 0;)
		status = eskel_volume_feed(volume, bytes, size, &error);
	if (status == ESKEL_OK)
		status = eskel_volume_finish(volume, &error);
	if (status != ESKEL_OK)
		give_up("%s: %s", path, error.text);
	fclose(file);
	return volume;
}

static eskel_cloud *cloud_of(const eskel_volume *volume, int32_t label, const char *name)
{
	eskel_cloud *cloud = NULL;
	eskel_error error = {0};
	if (eskel_volume_cloud(volume, label, &cloud, &error) != ESKEL_OK)
		give_up("%s, label %d: %s", name, label, error.text);
	return cloud;
}

void real_shape_compute(real_shape *shape, eskel_cloud *cloud)
{
	eskel_error error = {0};
	shape->cloud = cloud;
	if (eskel_skeleton_new(cloud, NULL, &shape->skeleton, &error) != ESKEL_OK)
		give_up("%s: %s", shape->name, error.text);
	if (eskel_signature_new(shape->skeleton, &shape->signature) != ESKEL_OK)
		give_up("%s has no signature", shape->name);
}

void real_shape_read(real_shape *shape, const char *path)
{
	eskel_volume *volume = real_volume(path);
	snprintf(shape->name, sizeof shape->name, "%s", strrchr(path, '/') + 1);
	real_shape_compute(shape, cloud_of(volume, eskel_volume_label(volume, 0), path));
	eskel_volume_free(volume);
}

void real_shape_clear(real_shape *shape)
{
	eskel_cloud_free(shape->cloud);
	eskel_skeleton_free(shape->skeleton);
	eskel_signature_free(shape->signature);
	*shape = (real_shape){0};
}

static real_shape *next_shape(real_set *set)
{
	if (set->count == SET_MAX)
		give_up("there are more than %d shapes", SET_MAX);
	return &set->shapes[set->count++];
}

static real_set empty_set(void)
{
	real_set set = {0, calloc(SET_MAX, sizeof(real_shape))};
	if (!set.shapes)
		give_up("memory ran out");
	return set;
}

/* file,source,subject,sex,age,class,side,... of which age and sex may be empty. */
static void read_manifest_line(char *line, real_shape *shape)
{
	char *fields[7], path[LINE_MAX_SIZE];
	for (int f = 0; f < 7; f++) {
		fields[f] = strsep(&line, ",");
		if (!fields[f])
			give_up("a line of the manifest has fewer than 7 fields");
	}
	snprintf(shape->subject, sizeof shape->subject, "%s", fields[2]);
	snprintf(shape->class_name, sizeof shape->class_name, "%s", fields[5]);
	snprintf(shape->side, sizeof shape->side, "%s", fields[6]);
	snprintf(path, sizeof path, REAL_DATA "%s", fields[0]);
	real_shape_read(shape, path);
}

real_set real_bones(void)
{
	char line[LINE_MAX_SIZE];
	real_set set = empty_set();
	FILE *manifest = open_file(REAL_DATA "manifest.csv");
	if (!fgets(line, sizeof line, manifest))
		give_up("the manifest has no header");
	while (fgets(line, sizeof line, manifest))
		read_manifest_line(line, next_shape(&set));
	fclose(manifest);
	return set;
}

static void split_side(const char *name, real_shape *shape)
{
	size_t length = strlen(name);
	bool left = length > 2 && strcmp(name + length - 2, "_L") == 0;
	bool right = length > 2 && strcmp(name + length - 2, "_R") == 0;
	snprintf(shape->name, sizeof shape->name, "%s", name);
	snprintf(shape->side, sizeof shape->side, "%s", left ? "left" : right ? "right" : "none");
	snprintf(shape->class_name, sizeof shape->class_name, "%.*s", (int)(left || right ? length - 2 : length), name);
}

real_set real_regions(void)
{
	char line[LINE_MAX_SIZE], name[64];
	int label;
	real_set set = empty_set();
	eskel_volume *volume = real_volume(REAL_ATLAS);
	FILE *names = open_file(REAL_ATLAS_NAMES);
	while (fgets(line, sizeof line, names))
		if (sscanf(line, "%d %63s", &label, name) == 2) {
			real_shape *shape = next_shape(&set);
			split_side(name, shape);
			real_shape_compute(shape, cloud_of(volume, label, name));
		}
	fclose(names);
	eskel_volume_free(volume);
	return set;
}

void real_set_clear(real_set *set)
{
	for (size_t s = 0; s < set->count; s++)
		real_shape_clear(&set->shapes[s]);
	free(set->shapes);
	*set = (real_set){0};
}
