/* MetaImage files made in memory: a header's text, then voxels. Each is decoded whole and byte by byte, to one end. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "volume_decode.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { most_bytes = 1 << 20 };

typedef struct {
	uint8_t bytes[most_bytes];
	size_t size;
} metaimage;

static metaimage file;

static const uint8_t cube[] = {0, 1, 1, 0, 0, 1, 2, 2};

static void append(const void *bytes, size_t size)
{
	assert_true(file.size + size <= most_bytes);
	memcpy(file.bytes + file.size, bytes, size);
	file.size += size;
}

/* A header of the lines, and the voxels. */
static void write_file(const char *lines, const void *voxels, size_t size)
{
	file.size = 0;
	append(lines, strlen(lines));
	append("ElementDataFile = LOCAL\n", strlen("ElementDataFile = LOCAL\n"));
	append(voxels, size);
}

/* A 2 x 2 x 2 volume of unsigned bytes, whose header has the further lines. */
static void write_cube(const char *further_lines)
{
	char lines[1024];
	snprintf(lines, sizeof lines, "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n%s",
		further_lines);
	write_file(lines, cube, sizeof cube);
}

static eskel_status decode(size_t size, size_t piece, eskel_volume **volume, eskel_error *error)
{
	return volume_decode(file.bytes, size, piece, NULL, volume, error);
}

static eskel_volume *decoded(size_t piece)
{
	eskel_volume *volume;
	eskel_error error = {0};
	if (decode(file.size, piece, &volume, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	return volume;
}

static void assert_refused(eskel_status status, const char *sentence)
{
	static const size_t pieces[] = {1, 7, most_bytes};
	for (size_t p = 0; p < sizeof pieces / sizeof *pieces; p++) {
		eskel_volume *volume;
		eskel_error error = {0};
		eskel_status got = decode(file.size, pieces[p], &volume, &error);
		assert_string_equal(error.text, sentence);
		assert_int_equal(got, status);
	}
}

static uint64_t voxels_of(const eskel_volume *volume, int32_t label)
{
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_volume_cloud(volume, label, &cloud, NULL), ESKEL_OK);
	uint64_t voxels = cloud->voxels;
	eskel_cloud_free(cloud);
	return voxels;
}

static void assert_cube(void)
{
	static const size_t pieces[] = {1, 5, most_bytes};
	for (size_t p = 0; p < sizeof pieces / sizeof *pieces; p++) {
		eskel_volume *volume = decoded(pieces[p]);
		assert_string_equal(eskel_volume_get_info(volume)->format, "MetaImage");
		assert_int_equal(eskel_volume_label_count(volume), 2);
		assert_int_equal(voxels_of(volume, 1), 3);
		assert_int_equal(voxels_of(volume, 2), 2);
		eskel_volume_free(volume);
	}
}

static void put(uint8_t *b, unsigned size, bool big_endian, uint64_t bits)
{
	for (unsigned i = 0; i < size; i++)
		b[big_endian ? size - 1 - i : i] = (uint8_t)(bits >> (8 * i));
}

static uint64_t stored(const char *type, double number)
{
	uint64_t bits = 0;
	float narrow = (float)number;
	if (strcmp(type, "MET_FLOAT") == 0)
		memcpy(&bits, &narrow, sizeof narrow);
	else if (strcmp(type, "MET_DOUBLE") == 0)
		memcpy(&bits, &number, sizeof number);
	else
		bits = (uint64_t)(int64_t)number;
	return bits;
}

static void every_type_and_byte_order_gives_its_labels(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		unsigned size;
		double labels[3]; /* ascending */
	} types[] = {
		{"MET_CHAR", 1, {-128, 1, 127}},
		{"MET_UCHAR", 1, {1, 128, 255}},
		{"MET_SHORT", 2, {-32768, 255, 32767}},
		{"MET_USHORT", 2, {1, 256, 65535}},
		{"MET_INT", 4, {-2147483647, 65536, 2147483647}},
		{"MET_UINT", 4, {1, 65536, 2147483647}},
		{"MET_LONG", 4, {-2147483647, 65536, 2147483647}},
		{"MET_ULONG", 4, {1, 65536, 2147483647}},
		{"MET_LONG_LONG", 8, {-2147483647, 65536, 2147483647}},
		{"MET_ULONG_LONG", 8, {1, 65536, 2147483647}},
		{"MET_FLOAT", 4, {-2, 300, 16777216}},
		{"MET_DOUBLE", 8, {-2147483647, 300, 2147483647}},
	};
	for (size_t t = 0; t < sizeof types / sizeof *types; t++)
		for (int big = 0; big < 2; big++) {
			char lines[200];
			uint8_t voxels[4 * 8] = {0};
			for (unsigned i = 0; i < 3; i++)
				put(voxels + i * types[t].size, types[t].size, big,
					stored(types[t].name, types[t].labels[i]));
			snprintf(lines, sizeof lines, "NDims = 3\nDimSize = 4 1 1\nElementType = %s\n%s = %s\n",
				types[t].name, t % 2 ? "BinaryDataByteOrderMSB" : "ElementByteOrderMSB",
				big ? "True" : "False");
			write_file(lines, voxels, 4 * types[t].size);
			eskel_volume *volume = decoded(3);
			assert_int_equal(eskel_volume_label_count(volume), 3);
			for (size_t i = 0; i < 3; i++)
				assert_int_equal(eskel_volume_label(volume, i), (int32_t)types[t].labels[i]);
			eskel_volume_free(volume);
		}
}

static void headers_as_people_write_them_are_read(void **state)
{
	(void)state;
	static const char *const further_lines[] = {
		"",
		"BinaryData = True\nBinaryDataByteOrderMSB = False\nElementByteOrderMSB = False\n",
		"ElementSpacing = 1 1 1\nElementSize = 2 2 2\nElementNumberOfChannels = 1\nHeaderSize = 0\n",
		"CompressedData = False\n",
		"HeaderSize = -1\nModality = MET_MOD_CT\nITK_InputFilterName = MetaImageIO\n\n",
		"Offset = 1 2 3\nPosition = 1 2 3\nbinarydata = nonsense\nCenterOfRotation = 9 9 9\n",
		"  Offset=\t1\t 2 3  \r\nBinaryData = true\r\nComment = a = b\r\n",
	};
	for (size_t i = 0; i < sizeof further_lines / sizeof *further_lines; i++) {
		write_cube(further_lines[i]);
		assert_cube();
	}
	write_file("Comment = a cube\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n", cube, sizeof cube);
	assert_cube();
}

static void voxels_may_begin_later_in_the_file(void **state)
{
	(void)state;
	write_cube("HeaderSize = 200\n");
	size_t header_size = file.size - sizeof cube;
	file.size = header_size;
	while (file.size < 200)
		append("x", 1);
	append(cube, sizeof cube);
	assert_cube();
	file.size = 150;
	assert_refused(ESKEL_TRUNCATED, "the file ends before byte 200, its first voxel");
	write_cube("HeaderSize = -1\n");
	append(cube, 1);
	assert_refused(ESKEL_MALFORMED, "the file goes on after its last voxel");
}

/* The file, whose voxels become a zlib stream. */
static void compress_voxels(const uint8_t *voxels, size_t size)
{
	uLongf compressed = compressBound((uLong)size);
	assert_true(file.size + compressed <= most_bytes);
	assert_int_equal(compress2(file.bytes + file.size, &compressed, voxels, (uLong)size, 6), Z_OK);
	file.size += compressed;
}

static void compressed_voxels_are_inflated(void **state)
{
	(void)state;
	write_cube("CompressedData = True\nCompressedDataSize = 16\n");
	file.size -= sizeof cube;
	compress_voxels(cube, sizeof cube);
	assert_cube();
}

static void compressed_voxels_may_be_many(void **state)
{
	(void)state;
	enum { count = 90 * 90 * 90 }; /* more than the inflater's window */
	uint8_t *voxels = malloc(count);
	assert_non_null(voxels);
	uint64_t expected = 0;
	for (size_t i = 0; i < count; i++) {
		voxels[i] = i * i % 1000 < 300;
		expected += voxels[i];
	}
	write_file("NDims = 3\nDimSize = 90 90 90\nElementType = MET_UCHAR\nCompressedData = True\n", "", 0);
	compress_voxels(voxels, count);
	free(voxels);
	static const size_t pieces[] = {1, 1000, most_bytes};
	for (size_t p = 0; p < 3; p++) {
		eskel_volume *volume = decoded(pieces[p]);
		assert_int_equal(voxels_of(volume, 1), expected);
		eskel_volume_free(volume);
	}
}

static void assert_affine(const double expected[3][4], const char *warnings)
{
	eskel_volume *volume = decoded(most_bytes);
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			if (info->affine.m[r][c] != expected[r][c])
				fail_msg("entry %d,%d is %.17g, expected %.17g", r, c, info->affine.m[r][c],
					expected[r][c]);
	char names[200] = "";
	for (size_t i = 0; i < info->warning_count; i++)
		snprintf(names + strlen(names), sizeof names - strlen(names), "%s ",
			eskel_warning_name(info->warnings[i].code));
	assert_string_equal(names, warnings);
	eskel_volume_free(volume);
}

static void each_axis_has_three_numbers_of_the_matrix_in_lps(void **state)
{
	(void)state;
	/* First index axis to the back, 2 mm; second to the feet, 3 mm; third to the left, 4 mm. */
	static const double expected[3][4] = {{0, 0, -4, -10}, {-2, 0, 0, -20}, {0, -3, 0, 30}};
	static const char *const names[][2] = {
		{"TransformMatrix", "Offset"}, {"Rotation", "Position"}, {"Orientation", "Origin"}};
	for (size_t i = 0; i < 3; i++) {
		char lines[300];
		snprintf(lines, sizeof lines,
			"ElementSpacing = 2 3 4\n%s = 0 1 0 0 0 -1 1 0 0\n%s = 1e1 20 +30.\n"
			"CenterOfRotation = 7 8 9\nAnatomicalOrientation = RAI\n",
			names[i][0], names[i][1]);
		write_cube(lines);
		assert_affine(expected, "");
	}
}

static void what_the_header_leaves_out_is_assumed_and_told(void **state)
{
	(void)state;
	static const double turned[3][4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}};
	static const double sized[3][4] = {{-2, 0, 0, 0}, {0, -3, 0, 0}, {0, 0, 4, 0}};
	write_cube("");
	assert_affine(turned, "unit_assumed no_orientation ");
	write_cube("TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementSize = 2 3 4\n");
	assert_affine(sized, "");
}

/* fixtures/volumes has a file for most refusals; here are the others. */
static void what_cannot_be_right_is_refused(void **state)
{
	(void)state;
	static const struct {
		const char *line;
		eskel_status status;
		const char *sentence;
	} cases[] = {
		{"Offset = 0 0 0\nOrigin = 1 0 0\n", ESKEL_MALFORMED,
			"the header says Offset = 0 0 0 and Origin = 1 0 0"},
		{"DimSize = 3 3 3\n", ESKEL_MALFORMED, "the header says DimSize = 2 2 2 and DimSize = 3 3 3"},
		{"Offset = 0 0\n", ESKEL_MALFORMED, "Offset is \"0 0\", expected 3 numbers"},
		{"Offset = 0 0 0 0\n", ESKEL_MALFORMED, "Offset is \"0 0 0 0\", expected 3 numbers"},
		{"Offset = 0 0 nan\n", ESKEL_MALFORMED, "Offset is \"0 0 nan\", expected 3 numbers"},
		{"Offset = 0 0 0x1\n", ESKEL_MALFORMED, "Offset is \"0 0 0x1\", expected 3 numbers"},
		{"Offset = 0 0 1,5\n", ESKEL_MALFORMED, "Offset is \"0 0 1,5\", expected 3 numbers"},
		{"Offset = 0 \xc3\xa9 \x01\n", ESKEL_MALFORMED, "Offset is \"0 ?? ?\", expected 3 numbers"},
		{"Offset = 0 0 1e999\n", ESKEL_BAD_GEOMETRY, "the affine's entry in row 2, column 3 is not finite"},
		{"HeaderSize = -2\n", ESKEL_MALFORMED,
			"HeaderSize is -2, expected -1, 0 or the header's 109 bytes to 16777216"},
		{"HeaderSize = 108\n", ESKEL_MALFORMED,
			"HeaderSize is 108, expected -1, 0 or the header's 110 bytes to 16777216"},
		{"HeaderSize = 1e30\n", ESKEL_MALFORMED,
			"HeaderSize is 1e+30, expected -1, 0 or the header's 111 bytes to 16777216"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		write_cube(cases[i].line);
		assert_refused(cases[i].status, cases[i].sentence);
	}
}

static void a_header_has_an_end(void **state)
{
	(void)state;
	const char line[] = "Comment = on and on it goes\n";
	file.size = 0;
	while (file.size < 2 * 65536)
		append(line, sizeof line - 1);
	assert_refused(ESKEL_MALFORMED, "the first 65536 bytes of the header have no line ElementDataFile = LOCAL");
	file.size = 0;
	append("NDims = 3\nOffset = ", 19);
	while (file.size < 19 + 401)
		append("1", 1);
	append("\nElementDataFile = LOCAL\n", 25);
	assert_refused(ESKEL_MALFORMED, "Offset has a value of 401 bytes, expected at most 400");
}

static void other_bytes_are_no_metaimage(void **state)
{
	(void)state;
	static const char *const texts[] = {"ObjectTidy and more", "NDim and more", "Commentary on it"};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		char sentence[200];
		file.size = 0;
		append(texts[i], strlen(texts[i]));
		snprintf(sentence, sizeof sentence,
			"the file begins with %02x %02x %02x %02x, expected a NIfTI-1, NIfTI-2, NRRD, MetaImage or MGH "
			"file, or an STL, PLY or OBJ mesh",
			file.bytes[0], file.bytes[1], file.bytes[2], file.bytes[3]);
		assert_refused(ESKEL_NOT_VOLUME, sentence);
	}
}

static void a_file_cut_anywhere_is_truncated(void **state)
{
	(void)state;
	for (int compressed = 0; compressed < 2; compressed++) {
		write_cube(compressed ? "CompressedData = True\n" : "");
		if (compressed) {
			file.size -= sizeof cube;
			compress_voxels(cube, sizeof cube);
		}
		for (size_t size = 0; size < file.size; size++) {
			eskel_volume *volume;
			assert_int_equal(decode(size, most_bytes, &volume, NULL), ESKEL_TRUNCATED);
			assert_int_equal(decode(size, 1, &volume, NULL), ESKEL_TRUNCATED);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_type_and_byte_order_gives_its_labels),
		cmocka_unit_test(headers_as_people_write_them_are_read),
		cmocka_unit_test(voxels_may_begin_later_in_the_file),
		cmocka_unit_test(compressed_voxels_are_inflated),
		cmocka_unit_test(compressed_voxels_may_be_many),
		cmocka_unit_test(each_axis_has_three_numbers_of_the_matrix_in_lps),
		cmocka_unit_test(what_the_header_leaves_out_is_assumed_and_told),
		cmocka_unit_test(what_cannot_be_right_is_refused),
		cmocka_unit_test(a_header_has_an_end),
		cmocka_unit_test(other_bytes_are_no_metaimage),
		cmocka_unit_test(a_file_cut_anywhere_is_truncated),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
