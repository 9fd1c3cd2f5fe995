#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "nifti_file.h"
#include "volume_decode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Refusals: fixtures/volumes, by test_volume.c. */

enum { most_bytes = 1 << 16 };

typedef struct {
	uint8_t bytes[most_bytes];
	size_t size;
} file;

/* A header of the lines given, closed by an empty one, and the bytes behind it. */
static file *file_of(const char *lines, const void *bytes, size_t size)
{
	file *f = calloc(1, sizeof *f);
	assert_non_null(f);
	f->size = (size_t)snprintf((char *)f->bytes, sizeof f->bytes, "%s\n", lines);
	assert_true(f->size + size <= sizeof f->bytes);
	if (size > 0)
		memcpy(f->bytes + f->size, bytes, size);
	f->size += size;
	return f;
}

static eskel_status feed(const file *f, size_t size, size_t piece, eskel_volume **volume, eskel_error *error)
{
	return volume_decode(f->bytes, size, piece, NULL, volume, error);
}

/* Decoded whole and byte by byte, which must give the same labels. The file is freed. */
static eskel_volume *decoded(file *f)
{
	eskel_volume *volume = NULL, *other = NULL;
	eskel_error error = {0};
	if (feed(f, f->size, f->size, &volume, &error) != ESKEL_OK || feed(f, f->size, 1, &other, &error) != ESKEL_OK)
		fail_msg("%s\n%s", error.text, (char *)f->bytes);
	assert_int_equal(eskel_volume_label_count(volume), eskel_volume_label_count(other));
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++)
		assert_int_equal(eskel_volume_label(volume, i), eskel_volume_label(other, i));
	assert_memory_equal(
		&eskel_volume_get_info(volume)->affine, &eskel_volume_get_info(other)->affine, sizeof(eskel_affine));
	eskel_volume_free(other);
	free(f);
	return volume;
}

/* The labels of a grid of 3 x 2 x 2 are those of expected[12]. */
enum { voxel_count = 12 };

static void assert_labels(const eskel_volume *volume, const double expected[voxel_count])
{
	double painted[voxel_count] = {0};
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++) {
		int32_t label = eskel_volume_label(volume, i);
		eskel_cloud *cloud = NULL;
		assert_int_equal(eskel_volume_cloud(volume, label, &cloud, NULL), ESKEL_OK);
		for (size_t r = 0; r < cloud->run_count; r++)
			for (unsigned x = cloud->runs[r].x_first; x <= cloud->runs[r].x_last; x++) {
				size_t gx = x + (size_t)cloud->affine.m[0][3];
				size_t gy = cloud->runs[r].y + (size_t)cloud->affine.m[1][3];
				size_t gz = cloud->runs[r].z + (size_t)cloud->affine.m[2][3];
				painted[gx + 3 * (gy + 2 * gz)] = label;
			}
		eskel_cloud_free(cloud);
	}
	for (int i = 0; i < voxel_count; i++)
		if (painted[i] != expected[i])
			fail_msg("voxel %d is %g, expected %g", i, painted[i], expected[i]);
}

#define GRID "dimension: 3\nsizes: 3 2 2\n"
#define RAS_GRID GRID "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"

/* The values as a type, 'u', 'i' or 'f', of size bytes. */
static size_t store(char kind, size_t size, bool big_endian, const double *values, uint8_t *bytes)
{
	for (size_t i = 0; i < voxel_count; i++) {
		uint64_t bits = kind == 'u' ? (uint64_t)values[i] : (uint64_t)(int64_t)values[i];
		const float single = (float)values[i];
		if (kind == 'f' && size == 8)
			memcpy(&bits, &values[i], 8);
		uint32_t bits32;
		memcpy(&bits32, &single, 4);
		if (kind == 'f' && size == 4)
			bits = bits32;
		for (size_t b = 0; b < size; b++)
			bytes[i * size + (big_endian ? size - 1 - b : b)] = (uint8_t)(bits >> 8 * b);
	}
	return voxel_count * size;
}

static void every_type_and_byte_order_gives_the_same_labels(void **state)
{
	(void)state;
	static const struct {
		const char *names;
		char kind;
		size_t size;
		double extremes[2];
	} types[] = {
		{"signed char,int8,int8_t,Signed Char", 'i', 1, {-128, 127}},
		{"uchar,unsigned char,uint8,uint8_t", 'u', 1, {128, 255}},
		{"short,short int,signed short,signed short int,int16,int16_t", 'i', 2, {-32768, 32767}},
		{"ushort,unsigned short,unsigned short int,uint16,uint16_t", 'u', 2, {256, 65535}},
		{"int,signed int,int32,int32_t", 'i', 4, {-2147483647, 2147483647}},
		{"uint,unsigned int,uint32,uint32_t", 'u', 4, {65536, 2147483647}},
		{"longlong,long long,long long int,signed long long,signed long long int,int64,int64_t", 'i', 8,
			{-2147483647, 2147483647}},
		{"ulonglong,unsigned long long,unsigned long long int,uint64,uint64_t", 'u', 8, {1, 2147483647}},
		{"float", 'f', 4, {-2, 16777216}},
		{"double", 'f', 8, {-2147483647, 2147483647}},
	};
	for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
		char names[200], lines[400];
		snprintf(names, sizeof names, "%s", types[t].names);
		const double *e = types[t].extremes;
		const double values[voxel_count] = {e[0], 0, 1, 1, 1, 0, 0, e[1], e[1], e[0], 1, e[1]};
		for (char *name = strtok(names, ","); name; name = strtok(NULL, ","))
			for (int big = 0; big < 2; big++) {
				uint8_t bytes[8 * voxel_count];
				size_t size = store(types[t].kind, types[t].size, big, values, bytes);
				snprintf(lines, sizeof lines,
					"NRRD0001\ntype: %s\n" RAS_GRID "encoding: raw\nendian: %s\n", name,
					big ? "big" : "little");
				eskel_volume *volume = decoded(file_of(lines, bytes, size));
				assert_labels(volume, values);
				assert_string_equal(eskel_volume_get_info(volume)->format, "NRRD");
				assert_false(eskel_volume_get_info(volume)->gzipped);
				assert_int_equal(eskel_volume_get_info(volume)->warning_count, 0);
				eskel_volume_free(volume);
			}
	}
}

static const double sample[voxel_count] = {0, 1, 1, 7, 0, 0, 200, 200, 200, 1, 0, 7};
static const uint8_t sample_bytes[voxel_count] = {0, 1, 1, 7, 0, 0, 200, 200, 200, 1, 0, 7};

static void every_encoding_gives_the_same_labels(void **state)
{
	(void)state;
	static const char text[] = "0 1 1\n7\t0 0.0\r\n2e2 200 +200\n1 -0 7", *const textual[] = {
										      "text", "txt", "ascii"};
	static const char *const gzipped[] = {"gzip", "gz", "GZIP"};
	char lines[300];
	size_t size;
	uint8_t *gzip = nifti_file_gzip(sample_bytes, voxel_count, &size);
	for (int i = 0; i < 3; i++) {
		snprintf(lines, sizeof lines, "NRRD0005\ntype: uint8\n" RAS_GRID "encoding: %s\n", gzipped[i]);
		eskel_volume *volume = decoded(file_of(lines, gzip, size));
		assert_labels(volume, sample);
		eskel_volume_free(volume);
		snprintf(lines, sizeof lines, "NRRD0005\ntype: int16\n" RAS_GRID "encoding: %s\n", textual[i]);
		volume = decoded(file_of(lines, text, sizeof text - 1));
		assert_labels(volume, sample);
		eskel_volume_free(volume);
	}
	free(gzip);
}

static void a_gzipped_file_may_have_gzipped_voxels(void **state)
{
	(void)state;
	size_t size;
	uint8_t *gzip = nifti_file_gzip(sample_bytes, voxel_count, &size);
	file *f = file_of("NRRD0004\ntype: uint8\n" RAS_GRID "encoding: gzip\n", gzip, size);
	free(gzip);
	gzip = nifti_file_gzip(f->bytes, f->size, &size);
	memcpy(f->bytes, gzip, size);
	f->size = size;
	eskel_volume *volume = decoded(f);
	assert_labels(volume, sample);
	assert_true(eskel_volume_get_info(volume)->gzipped);
	eskel_volume_free(volume);
	free(gzip);
}

enum { text_piece = 1 << 20, most_text_pieces = 256 };

/* A volume that so many pieces of blanks, in the place of text, were fed to. */
static eskel_volume *fed_blanks(int pieces)
{
	static const char header[] = "NRRD0004\ntype: uint8\n" RAS_GRID "encoding: text\n\n";
	eskel_volume *volume;
	char *blanks = malloc(text_piece);
	assert_non_null(blanks);
	memset(blanks, ' ', text_piece);
	assert_int_equal(eskel_volume_new(NULL, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_feed(volume, header, sizeof header - 1, NULL), ESKEL_OK);
	for (int i = 0; i < pieces; i++)
		assert_int_equal(eskel_volume_feed(volume, blanks, text_piece, NULL), ESKEL_OK);
	free(blanks);
	return volume;
}

static void text_may_end_with_the_last_byte_that_it_may_have(void **state)
{
	(void)state;
	eskel_volume *volume = fed_blanks(most_text_pieces - 1);
	eskel_error error = {0};
	char *last = malloc(text_piece + 1);
	assert_non_null(last);
	memset(last, ' ', text_piece);
	for (int i = 0; i < voxel_count; i++)
		snprintf(last + text_piece - 4 * (voxel_count - i), 5, "%4d", sample_bytes[i]);
	assert_int_equal(eskel_volume_feed(volume, last, text_piece, &error), ESKEL_OK);
	if (eskel_volume_finish(volume, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	assert_labels(volume, sample);
	eskel_volume_free(volume);
	free(last);
}

static void text_without_end_is_refused(void **state)
{
	(void)state;
	eskel_volume *volume = fed_blanks(most_text_pieces);
	eskel_error error = {0};
	assert_int_equal(eskel_volume_feed(volume, " ", 1, &error), ESKEL_TOO_LARGE);
	assert_string_equal(
		error.text, "the voxels take more than 268435456 bytes of text, expected another encoding for so many");
	eskel_volume_free(volume);
}

static void lines_may_end_in_crlf_and_fields_in_any_order_and_case(void **state)
{
	(void)state;
	static const char lines[] = "NRRD0004\r\n# space: LAS\r\nSpace Directions: (1, 0, 0)  ( 0 ,1,0) (0,0,1) \r\n"
				    "SIZES:  3 2 2\r\ncontent: a: b\r\nkey:with colon:=spacings: 3\r\nENCODING: Raw\r\n"
				    "measurement frame: (1,0,0) (0,1,0) (0,0,1)\r\nkinds: space domain ???\r\n"
				    "space: ras\r\ndimension: 3\r\ntype: UChar\r\nbyteskip: 0\r\n\r";
	eskel_volume *volume = decoded(file_of(lines, sample_bytes, voxel_count));
	assert_labels(volume, sample);
	eskel_volume_free(volume);
}

static void a_cut_file_is_truncated_wherever_it_is_cut(void **state)
{
	(void)state;
	size_t size;
	uint8_t *gzip = nifti_file_gzip(sample_bytes, voxel_count, &size);
	const char *text = "0 1 1 7 0 0 200 200 200 1 0 7\n";
	file *files[] = {
		file_of("NRRD0004\ntype: uint8\n" RAS_GRID "encoding: raw\n", sample_bytes, voxel_count),
		file_of("NRRD0004\ntype: uint8\n" RAS_GRID "encoding: gzip\n", gzip, size),
		file_of("NRRD0004\ntype: uint8\n" RAS_GRID "encoding: text\n", text, strlen(text) - 2),
	};
	for (size_t i = 0; i < 3; i++) {
		for (size_t end = 0; end < files[i]->size; end++) {
			eskel_volume *volume = NULL;
			eskel_error error = {0};
			if (feed(files[i], end, 7, &volume, &error) != ESKEL_TRUNCATED)
				fail_msg("%zu of %zu bytes: %s", end, files[i]->size, error.text);
		}
		free(files[i]);
	}
	free(gzip);
}

static void assert_affine(const char *lines, const double expected[3][4], const char *warnings)
{
	char header[1000], names[200] = "";
	snprintf(header, sizeof header, "NRRD0004\ntype: uint8\nencoding: raw\n%s", lines);
	eskel_volume *volume = decoded(file_of(header, sample_bytes, voxel_count));
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	for (size_t i = 0; i < info->warning_count; i++)
		strcat(strcat(names, i > 0 ? " " : ""), eskel_warning_name(info->warnings[i].code));
	assert_string_equal(names, warnings);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			if (info->affine.m[r][c] != expected[r][c])
				fail_msg("%s: row %d, column %d is %g, expected %g", lines, r, c, info->affine.m[r][c],
					expected[r][c]);
	assert_int_equal(info->extent[0], 3);
	assert_int_equal(info->extent[1], 2);
	assert_int_equal(info->extent[2], 2);
	eskel_volume_free(volume);
}

#define OBLIQUE "space directions: (1,2,0) (-2,1,0.5) (0,0.25,-3)\nspace origin: (10,20,-30)\n"

static void spaces_turn_to_ras(void **state)
{
	(void)state;
	static const struct {
		const char *names;
		double x, y;
		const char *warnings;
	} spaces[] = {
		{"RAS,right-anterior-superior,Right-Anterior-Superior", 1, 1, ""},
		{"LAS,left-anterior-superior", -1, 1, ""},
		{"LPS,left-posterior-superior", -1, -1, ""},
		{"scanner-xyz,3D-right-handed", 1, 1, "no_orientation unit_assumed"},
		{"3D-left-handed", -1, 1, "no_orientation unit_assumed"},
	};
	for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++) {
		const double x = spaces[s].x, y = spaces[s].y;
		const double expected[3][4] = {{x, -2 * x, 0, 10 * x}, {2 * y, y, 0.25 * y, 20 * y}, {0, 0.5, -3, -30}};
		char names[200], lines[300];
		snprintf(names, sizeof names, "%s", spaces[s].names);
		for (char *name = strtok(names, ","); name; name = strtok(NULL, ",")) {
			snprintf(lines, sizeof lines, GRID "space: %s\n" OBLIQUE, name);
			assert_affine(lines, expected, spaces[s].warnings);
		}
	}
	const double plain[3][4] = {{1, -2, 0, 10}, {2, 1, 0.25, 20}, {0, 0.5, -3, -30}};
	assert_affine(GRID "space dimension: 3\n" OBLIQUE, plain, "no_orientation unit_assumed");
}

static void an_axis_of_one_sample_need_not_be_in_space(void **state)
{
	(void)state;
	static const double expected[3][4] = {{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 4, 0}};
	assert_affine("dimension: 4\nsizes: 1 3 2 2\nkinds: list domain domain domain\nspace: RAS\n"
		      "space directions: none (2,0,0) (0,3,0) (0,0,4)\n",
		expected, "");
	assert_affine("dimension: 4\nsizes: 3 2 2 1\nspace: RAS\nspace directions: (2,0,0) (0,3,0) (0,0,4) none\n",
		expected, "");
	assert_affine("dimension: 4\nsizes: 3 1 2 2\nkinds: space vector space space\nspacings: 2 nan 3 4\n"
		      "units: \"mm\" \"\" \"mm\" \"mm\"\n",
		expected, "no_orientation");
}

static void units_become_millimetres(void **state)
{
	(void)state;
	static const double expected[3][4] = {{1, 0, 0, 1.5}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	static const char directions[] = "(1000,0,0) (0,1000,0) (0,0,1000)\nspace origin: (1500,0,0)\n";
	char lines[300];
	snprintf(lines, sizeof lines, GRID "space: RAS\nspace units: \"um\" \"um\" \"um\"\nspace directions: %s",
		directions);
	assert_affine(lines, expected, "");
	assert_affine(GRID "space: RAS\nspace units: \"mm\" \"mm\" \"mm\"\n"
			   "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (1.5,0,0)\n",
		expected, "");
	assert_affine(GRID "space: RAS\nspace units: \"ell\" \"ell\" \"ell\"\n"
			   "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (1.5,0,0)\n",
		expected, "unit_assumed");
	assert_affine(GRID "spacings: 0.1 0.1 0.1\nunits: \"cm\" \"cm\" \"cm\"\naxis mins: 0.15 nan nan\ncenters: node "
			   "cell cell\n",
		expected, "no_orientation");
}

static void an_axis_min_is_the_border_of_a_cell_or_the_place_of_a_node(void **state)
{
	(void)state;
	static const double expected[3][4] = {{2, 0, 0, 11}, {0, 4, 0, 20}, {0, 0, 6, 33}};
	assert_affine(GRID "spacings: 2 4 6\naxis mins: 10 20 30\ncenterings: cell node ???\n", expected,
		"no_orientation unit_assumed");
}

static void segments_give_their_labels_names(void **state)
{
	(void)state;
#define ENTRY(type, modifier, region, region_modifier) \
	"Segmentation.Status:inprogress|Segmentation.TerminologyEntry:General Anatomy~SCT^1^Tissue~" type "~" modifier \
	"~DICOM master list~" region "~" region_modifier "|Other:a~b~c~d~e~f~g|\n"
	static const char segments[] =
		"Segment0_ID:=Segment_1\n"
		"Segment0_LabelValue:=200\n"
		"Segment0_Layer:=0\n"
		"Segment0_Name:=left \\\\ talus\\n(L)\n"
		"Segment0_Tags:=" ENTRY("SCT^2^Bone", "SCT^3^Left", "^^",
			"^^") "Segment1_Name:=Segment_2\n"
			      "Segment1_LabelValue:=7\n"
			      "Segment1_Tags:=" ENTRY("SCT^2^Femur", "SCT^3^Right", "^^",
				      "^^") "Segment2_LabelValue:=1\n"
					    "Segment2_Name:=\n"
					    "Segment2_Tags:=" ENTRY("SCT^2^Bone", "^^", "SCT^4^Tibia",
						    "SCT^3^Left") "Segment3_LabelValue:=9\n"
								  "Segment3_Name:=Segment_4\n"
								  "Segment3_Tags:=" ENTRY("SCT^2^Tissue", "^^", "^^",
									  "^^") "Segmentation_MasterRepresentation:="
										"Binary labelmap\n"
										"Segment4_Name:=again\n"
										"Segment4_LabelValue:=200\n";
	char lines[2000];
	snprintf(lines, sizeof lines, "NRRD0004\ntype: uint8\n" RAS_GRID "encoding: raw\n%s", segments);
	eskel_volume *volume = decoded(file_of(lines, sample_bytes, voxel_count));
	assert_string_equal(eskel_volume_label_name(volume, 200), "left \\ talus (L)");
	assert_string_equal(eskel_volume_label_name(volume, 7), "Femur right");
	assert_string_equal(eskel_volume_label_name(volume, 1), "Tibia left");
	assert_null(eskel_volume_label_name(volume, 9));
	assert_null(eskel_volume_label_name(volume, 2));
	eskel_volume_free(volume);
}

static void a_long_name_is_cut_before_a_character(void **state)
{
	(void)state;
	char lines[1000], name[400] = "";
	for (int i = 0; i < 100; i++)
		strcat(name, i == 0 ? "x" : "\xc3\xa4");
	snprintf(lines, sizeof lines,
		"NRRD0004\ntype: uint8\n" RAS_GRID "encoding: raw\nSegment0_LabelValue:=7\nSegment0_Name:=%s\n", name);
	eskel_volume *volume = decoded(file_of(lines, sample_bytes, voxel_count));
	name[193] = 0; /* 194 bytes would cut the 97th letter */
	assert_string_equal(eskel_volume_label_name(volume, 7), name);
	eskel_volume_free(volume);
}

#define LAYERED \
	"NRRD0004\nencoding: raw\ndimension: 4\nsizes: 2 3 2 2\nkinds: list domain domain domain\nspace: RAS\n" \
	"space directions: none (1,0,0) (0,1,0) (0,0,1)\n"

/* Of each voxel the value in the first layer, then that in the second. */
static const uint8_t overlapping[2 * voxel_count] = {
	0, 0, 1, 0, 1, 1, 0, 1, 2, 0, 2, 9, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 2};

static void assert_voxels(const eskel_volume *volume, const char *expected)
{
	char found[200] = "";
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++) {
		const int32_t label = eskel_volume_label(volume, i);
		const char *name = eskel_volume_label_name(volume, label);
		eskel_cloud *cloud = NULL;
		assert_int_equal(eskel_volume_cloud(volume, label, &cloud, NULL), ESKEL_OK);
		size_t used = strlen(found);
		snprintf(found + used, sizeof found - used, "%s%d %s %d", i > 0 ? ", " : "", label, name ? name : "-",
			(int)cloud->voxels);
		eskel_cloud_free(cloud);
	}
	assert_string_equal(found, expected);
}

static void overlapping_segments_are_labelled_by_value_or_by_number(void **state)
{
	(void)state;
	static const struct {
		const char *segments, *expected;
	} cases[] = {
		{"Segment0_LabelValue:=2\nSegment0_Layer:=0\nSegment0_Name:=a\n"
		 "Segment1_LabelValue:=1\nSegment1_Layer:=1\nSegment1_Name:=b\n",
			"1 b 3, 2 a 3"},
		{"Segment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Name:=a\n"
		 "Segment1_LabelValue:=1\nSegment1_Layer:=1\n"
		 "Segment3_LabelValue:=2\nSegment3_Layer:=1\nSegment3_Name:=c\n",
			"1 a 3, 2 - 3, 4 c 1"},
		{"Segment0_Name:=a\nSegment1_Name:=b\n", "1 a 3, 2 b 3"},
	};
	char lines[600];
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(lines, sizeof lines, LAYERED "type: uint8\n%s", cases[i].segments);
		eskel_volume *volume = decoded(file_of(lines, overlapping, sizeof overlapping));
		assert_voxels(volume, cases[i].expected);
		eskel_volume_free(volume);
	}
}

static void only_wanted_segments_are_kept(void **state)
{
	(void)state;
	file *f = file_of(LAYERED "type: uint8\nSegment0_Layer:=0\nSegment1_Layer:=1\nSegment2_Layer:=1\n"
				  "Segment2_LabelValue:=9\n",
		overlapping, sizeof overlapping);
	static const int32_t wanted[] = {3, 7};
	eskel_volume *volume = NULL;
	assert_int_equal(
		eskel_volume_new(&(eskel_volume_options){.labels = wanted, .label_count = 2}, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_feed(volume, f->bytes, f->size, NULL), ESKEL_OK);
	assert_int_equal(eskel_volume_finish(volume, NULL), ESKEL_OK);
	assert_voxels(volume, "3 - 1");
	eskel_volume_free(volume);
	free(f);
}

static void the_first_bad_voxel_of_all_layers_is_told_however_the_file_is_cut(void **state)
{
	(void)state;
	float values[2 * voxel_count] = {0};
	values[2 * 7] = 0.5f;      /* voxel 7 of the first layer */
	values[2 * 4 + 1] = 0.25f; /* voxel 4 of the second */
	file *f = file_of(
		LAYERED "type: float\nendian: little\nSegment0_Layer:=0\nSegment1_Layer:=1\n", values, sizeof values);
	for (size_t piece = 1; piece <= f->size; piece += piece < 9 ? 1 : f->size - piece) {
		eskel_volume *volume = NULL;
		eskel_error error = {0};
		assert_int_equal(feed(f, f->size, piece, &volume, &error), ESKEL_BAD_VALUE);
		assert_string_equal(error.text, "voxel (1, 1, 0) is 0.25, expected an integer between -2^31 and 2^31");
		if (piece == f->size)
			break;
	}
	free(f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_type_and_byte_order_gives_the_same_labels),
		cmocka_unit_test(every_encoding_gives_the_same_labels),
		cmocka_unit_test(a_gzipped_file_may_have_gzipped_voxels),
		cmocka_unit_test(text_may_end_with_the_last_byte_that_it_may_have),
		cmocka_unit_test(text_without_end_is_refused),
		cmocka_unit_test(lines_may_end_in_crlf_and_fields_in_any_order_and_case),
		cmocka_unit_test(a_cut_file_is_truncated_wherever_it_is_cut),
		cmocka_unit_test(spaces_turn_to_ras),
		cmocka_unit_test(an_axis_of_one_sample_need_not_be_in_space),
		cmocka_unit_test(units_become_millimetres),
		cmocka_unit_test(an_axis_min_is_the_border_of_a_cell_or_the_place_of_a_node),
		cmocka_unit_test(segments_give_their_labels_names),
		cmocka_unit_test(a_long_name_is_cut_before_a_character),
		cmocka_unit_test(overlapping_segments_are_labelled_by_value_or_by_number),
		cmocka_unit_test(only_wanted_segments_are_kept),
		cmocka_unit_test(the_first_bad_voxel_of_all_layers_is_told_however_the_file_is_cut),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
