/* MGH files made in memory: header, voxels, footer. Each is decoded whole and in pieces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { header_size = 284, most_bytes = 1 << 21, scan_size = 20 };

typedef struct {
	uint8_t bytes[most_bytes];
	size_t size;
} mgh;

static mgh file;

static void append(const void *bytes, size_t size)
{
	assert_true(file.size + size <= most_bytes);
	memcpy(file.bytes + file.size, bytes, size);
	file.size += size;
}

static void append_integer(unsigned size, int64_t value)
{
	uint8_t bytes[8];
	for (unsigned i = 0; i < size; i++)
		bytes[i] = (uint8_t)((uint64_t)value >> (8 * (size - 1 - i)));
	append(bytes, size);
}

static void append_float(double value)
{
	const float narrow = (float)value;
	uint32_t bits;
	memcpy(&bits, &narrow, sizeof bits);
	append_integer(4, bits);
}

static void append_floats(const double *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		append_float(values[i]);
}

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, ones[3] = {1, 1, 1}, zeros[3] = {0, 0, 0};

static void write_header(int nx, int ny, int nz, int type, int is_valid, const double spacing[3],
	const double directions[9], const double middle[3])
{
	static const uint8_t padding[header_size];
	file.size = 0;
	append_integer(4, 1);
	append_integer(4, nx);
	append_integer(4, ny);
	append_integer(4, nz);
	append_integer(4, 1);
	append_integer(4, type);
	append_integer(4, 0);
	append_integer(2, is_valid);
	append_floats(spacing, 3);
	append_floats(directions, 9);
	append_floats(middle, 3);
	append(padding, header_size - file.size);
}

/* 2 x 2 x 2 voxels of labels 17 (three) and 1000 (two). */
static void write_cube(void)
{
	static const int voxels[] = {0, 17, 17, 0, 0, 17, 1000, 1000};
	write_header(2, 2, 2, 4, 1, ones, identity, zeros);
	for (int i = 0; i < 8; i++)
		append_integer(2, voxels[i]);
}

static void append_scan(void)
{
	static const uint8_t scan[scan_size];
	append(scan, scan_size);
}

static void append_text(const char *text)
{
	append_integer(4, (int64_t)strlen(text) + 1);
	append(text, strlen(text) + 1);
}

static void append_name(const char *name)
{
	append_text(name);
	for (int i = 0; i < 4; i++)
		append_integer(4, 255);
}

/* Begins a table of the second form. */
static void append_table(int count)
{
	append_integer(4, 1);
	append_integer(4, -2);
	append_integer(4, 2000);
	append_text("subject/table.txt");
	append_integer(4, count);
}

static void append_tag(int tag, const char *content)
{
	append_integer(4, tag);
	append_integer(8, (int64_t)strlen(content));
	append(content, strlen(content));
}

static eskel_volume *decoded(size_t piece)
{
	eskel_volume *v = NULL;
	eskel_error error = {0};
	assert_int_equal(eskel_volume_new(NULL, &v), ESKEL_OK);
	eskel_status status = ESKEL_OK;
	for (size_t at = 0; at < file.size && status == ESKEL_OK; at += piece)
		status = eskel_volume_feed(v, file.bytes + at, piece < file.size - at ? piece : file.size - at, &error);
	if (status == ESKEL_OK)
		status = eskel_volume_finish(v, &error);
	if (status != ESKEL_OK)
		fail_msg("%s", error.text);
	return v;
}

static void assert_name(const eskel_volume *volume, int32_t label, const char *name)
{
	const char *got = eskel_volume_label_name(volume, label);
	if (!name != !got || (name && strcmp(name, got) != 0))
		fail_msg("label %d is called %s, expected %s", label, got ? got : "nothing", name ? name : "nothing");
}

static const char assumed[] =
	"the file has no colour table; labels have the names that they have in FreeSurfer's aseg.mgz";

/* Of the labels 17 and 1000; warning: the sentence, NULL for none. */
static void assert_names(const char *name, const char *other_name, const char *warning)
{
	const size_t pieces[] = {file.size, 7, 1};
	for (size_t p = 0; p < 3; p++) {
		eskel_volume *volume = decoded(pieces[p]);
		assert_name(volume, 17, name);
		assert_name(volume, 1000, other_name);
		const eskel_volume_info *info = eskel_volume_get_info(volume);
		assert_int_equal(info->warning_count, warning != NULL);
		if (warning) {
			assert_int_equal(info->warnings[0].code,
				warning == assumed ? ESKEL_WARNING_NAMES_ASSUMED : ESKEL_WARNING_NAMES_INCOMPLETE);
			assert_string_equal(info->warnings[0].text, warning);
		}
		eskel_volume_free(volume);
	}
}

static void every_type_gives_the_same_labels(void **state)
{
	(void)state;
	static const struct {
		int type;
		unsigned size;
		int64_t label;
	} types[] = {{0, 1, 255}, {4, 2, 32767}, {4, 2, -32768}, {10, 2, 65535}, {1, 4, INT32_MAX}, {1, 4, -1},
		{3, 0, 16777216}};
	for (size_t t = 0; t < sizeof types / sizeof types[0]; t++) {
		write_header(3, 1, 2, types[t].type, 1, ones, identity, zeros);
		for (int i = 0; i < 6; i++)
			if (types[t].size == 0)
				append_float((double)(i < 4 ? types[t].label : 0));
			else
				append_integer(types[t].size, i < 4 ? types[t].label : 0);
		append_scan();
		eskel_volume *volume = decoded(5);
		eskel_cloud *cloud = NULL;
		assert_string_equal(eskel_volume_get_info(volume)->format, "MGH");
		assert_int_equal(eskel_volume_label_count(volume), 1);
		assert_int_equal(eskel_volume_label(volume, 0), types[t].label);
		assert_int_equal(eskel_volume_cloud(volume, (int32_t)types[t].label, &cloud, NULL), ESKEL_OK);
		assert_int_equal(cloud->voxels, 4);
		eskel_cloud_free(cloud);
		eskel_volume_free(volume);
	}
}

static void assert_affine(const double expected[3][4])
{
	eskel_volume *volume = decoded(file.size);
	const eskel_affine *affine = &eskel_volume_get_info(volume)->affine;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			if (affine->m[r][c] != expected[r][c])
				fail_msg("row %d, column %d is %g, expected %g", r, c, affine->m[r][c], expected[r][c]);
	eskel_volume_free(volume);
}

/* FreeSurfer's conformed volumes: 256 voxels of 1 mm, coronal. */
static void the_middle_of_the_grid_is_where_the_header_says(void **state)
{
	(void)state;
	static const double coronal[9] = {-1, 0, 0, 0, 0, -1, 0, 1, 0}, spacing[3] = {1, 2, 0.5},
			    middle[3] = {10, 20, 30};
	static const double expected[3][4] = {{-1, 0, 0, 12}, {0, 0, 0.5, 19.5}, {0, -2, 0, 33}};
	write_header(4, 3, 2, 0, 1, spacing, coronal, middle);
	append("\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1", 24);
	assert_affine(expected);
}

static void without_geometry_the_axes_are_coronal_with_two_warnings(void **state)
{
	(void)state;
	static const double coronal[3][4] = {{-1, 0, 0, 2}, {0, 0, 1, -1}, {0, -1, 0, 1.5}};
	static const double junk[9] = {7, 0, 0, 7, 0, 0, -1, 0, 0};
	write_header(4, 3, 2, 0, 0, zeros, junk, junk);
	append("\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1\1", 24);
	assert_affine(coronal);
	eskel_volume *volume = decoded(file.size);
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	assert_int_equal(info->warning_count, 2);
	assert_int_equal(info->warnings[0].code, ESKEL_WARNING_NO_ORIENTATION);
	assert_int_equal(info->warnings[1].code, ESKEL_WARNING_UNIT_ASSUMED);
	eskel_volume_free(volume);
}

static void without_a_colour_table_the_labels_of_aseg_have_their_names(void **state)
{
	(void)state;
	write_cube();
	assert_names("Left-Hippocampus", NULL, assumed);
	append("\0\0\0", 3);
	assert_names("Left-Hippocampus", NULL, assumed);
	write_cube();
	append_scan();
	append_tag(3, "mri_convert in.mgz");
	assert_names("Left-Hippocampus", NULL, assumed);
}

static void labels_that_aseg_has_not_are_not_named_nor_warned_of(void **state)
{
	(void)state;
	write_header(2, 1, 1, 0, 1, ones, identity, zeros);
	append("\1\6", 2);
	append_scan();
	eskel_volume *volume = decoded(1);
	assert_name(volume, 1, NULL);
	assert_name(volume, 6, NULL);
	assert_int_equal(eskel_volume_get_info(volume)->warning_count, 0);
	eskel_volume_free(volume);
}

static void both_forms_of_the_colour_table_name_labels(void **state)
{
	(void)state;
	write_cube();
	append_scan();
	append_tag(31, "subject/talairach.xfm");
	append_table(3);
	append_integer(4, 0);
	append_name("Unknown");
	append_integer(4, 1000);
	append_name("ctx-lh-unknown");
	append_integer(4, 17);
	append_name("  my hippocampus\n");
	append_tag(42, "a frame");
	assert_names("my hippocampus", "ctx-lh-unknown", NULL);
	write_cube();
	append_scan();
	append_integer(4, 1);
	append_integer(4, 18);
	append_text("");
	for (int i = 0; i < 18; i++) {
		char name[20];
		snprintf(name, sizeof name, "label %d", i);
		append_name(name);
	}
	assert_names("label 17", NULL, NULL);
}

static void nothing_is_read_behind_the_end_or_a_tag_of_surfaces_and_warps(void **state)
{
	(void)state;
	static const int tags[] = {0, 2, 10, 11, 12, 20, 30};
	for (size_t i = 0; i < sizeof tags / sizeof tags[0]; i++) {
		write_cube();
		append_scan();
		append_table(1);
		append_integer(4, 1000);
		append_name("cortex");
		append_integer(4, tags[i]);
		append("\0\0\0\1\0\0\0", 7);
		assert_names(NULL, "cortex", NULL);
	}
}

/* Cut anywhere, a footer gives the names before the cut. */
static void a_footer_that_breaks_off_ends_the_names_with_a_warning(void **state)
{
	(void)state;
	write_cube();
	append_scan();
	append_table(2);
	const size_t table = file.size;
	append_integer(4, 17);
	append_name("hippocampus");
	const size_t first = file.size;
	append_integer(4, 1000);
	append_name("cortex");
	const size_t second = file.size;
	append_tag(3, "mri_convert");
	const size_t whole = file.size;
	for (file.size = table - 30; file.size < whole; file.size++) {
		const bool has_first = file.size >= first, has_second = file.size >= second;
		char warning[200];
		snprintf(warning, sizeof warning,
			"what follows the voxels breaks off or is damaged; %d label names were read",
			has_first + has_second);
		const bool is_whole = file.size >= second && file.size < second + 4;
		assert_names(has_first ? "hippocampus" : NULL, has_second ? "cortex" : NULL, is_whole ? NULL : warning);
	}
}

static void damaged_sizes_end_the_names_with_a_warning(void **state)
{
	(void)state;
	static const char warning[] = "what follows the voxels breaks off or is damaged; 0 label names were read";
	static const int forms[] = {0, -1, -3, INT32_MIN};
	for (size_t i = 0; i < 4; i++) {
		write_cube();
		append_scan();
		append_integer(4, 1);
		append_integer(4, forms[i]);
		append("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 20);
		assert_names(NULL, NULL, warning);
	}
	static const int64_t sizes[] = {-1, INT64_MIN, INT64_MAX, 100};
	for (size_t i = 0; i < 4; i++) {
		write_cube();
		append_scan();
		append_integer(4, 3);
		append_integer(8, sizes[i]);
		assert_names(NULL, NULL, warning);
		write_cube();
		append_scan();
		append_integer(4, 1);
		append_integer(4, INT32_MAX);
		append_text("table");
		append_integer(4, sizes[i]);
		assert_names(NULL, NULL, warning);
	}
}

static void a_footer_may_have_a_MiB(void **state)
{
	(void)state;
	write_cube();
	const size_t before = file.size;
	append_scan();
	append_table(1);
	append_integer(4, 17);
	append_name("hippocampus");
	append_integer(4, 3);
	append_integer(8, (int64_t)((1 << 20) - (file.size - before) - 8));
	while (file.size < before + (1 << 20))
		append("", 1);
	eskel_volume *volume = decoded(file.size);
	assert_name(volume, 17, "hippocampus");
	assert_int_equal(eskel_volume_get_info(volume)->warning_count, 0);
	eskel_volume_free(volume);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_type_gives_the_same_labels),
		cmocka_unit_test(the_middle_of_the_grid_is_where_the_header_says),
		cmocka_unit_test(without_geometry_the_axes_are_coronal_with_two_warnings),
		cmocka_unit_test(without_a_colour_table_the_labels_of_aseg_have_their_names),
		cmocka_unit_test(labels_that_aseg_has_not_are_not_named_nor_warned_of),
		cmocka_unit_test(both_forms_of_the_colour_table_name_labels),
		cmocka_unit_test(nothing_is_read_behind_the_end_or_a_tag_of_surfaces_and_warps),
		cmocka_unit_test(a_footer_that_breaks_off_ends_the_names_with_a_warning),
		cmocka_unit_test(damaged_sizes_end_the_names_with_a_warning),
		cmocka_unit_test(a_footer_may_have_a_MiB),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
