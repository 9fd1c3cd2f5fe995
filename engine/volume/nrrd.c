/* The headers of NRRD files with their voxels attached (Nearly Raw Raster Data, versions 1 to 5, as teem defines it).
 *
 * A header is lines of text up to an empty one. It comes a line at a time, so that no byte behind it is taken: a line that
 * names another file is refused where it ends, for such a header needs no empty line.
 *
 * Stricter than teem: a voxel must be of one type and size known from the header alone, a line or byte skip must be 0, and a
 * voxel's size must be said. A fourth axis is accepted when it is not in space and has one sample, or is the first and
 * of the layers of 3D Slicer's segments.
 */
#include "error.h"
#include "layers.h"
#include "nrrd_geometry.h"
#include "nrrd_segments.h"
#include "volume_format.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* Segmentations have up to a kilobyte a segment, of terminology. */
enum { largest_header = 1 << 20, magic_size = 8, longest_axis = 65535 };

typedef struct {
	esk_nrrd_axes axes;
	esk_volume_header *header; /* to be filled */
} reading;

static const char *value_of(const reading *r, esk_nrrd_field field)
{
	return r->axes.fields->values[field];
}

static const struct {
	const char *name;
	esk_voxel_kind kind;
	unsigned size;
} types[] = {
	{"signed char", ESK_VOXEL_SIGNED, 1},
	{"char", ESK_VOXEL_SIGNED, 1},
	{"int8", ESK_VOXEL_SIGNED, 1},
	{"int8_t", ESK_VOXEL_SIGNED, 1},
	{"uchar", ESK_VOXEL_UNSIGNED, 1},
	{"unsigned char", ESK_VOXEL_UNSIGNED, 1},
	{"uint8", ESK_VOXEL_UNSIGNED, 1},
	{"uint8_t", ESK_VOXEL_UNSIGNED, 1},
	{"short", ESK_VOXEL_SIGNED, 2},
	{"short int", ESK_VOXEL_SIGNED, 2},
	{"signed short", ESK_VOXEL_SIGNED, 2},
	{"signed short int", ESK_VOXEL_SIGNED, 2},
	{"int16", ESK_VOXEL_SIGNED, 2},
	{"int16_t", ESK_VOXEL_SIGNED, 2},
	{"ushort", ESK_VOXEL_UNSIGNED, 2},
	{"unsigned short", ESK_VOXEL_UNSIGNED, 2},
	{"unsigned short int", ESK_VOXEL_UNSIGNED, 2},
	{"uint16", ESK_VOXEL_UNSIGNED, 2},
	{"uint16_t", ESK_VOXEL_UNSIGNED, 2},
	{"int", ESK_VOXEL_SIGNED, 4},
	{"signed int", ESK_VOXEL_SIGNED, 4},
	{"int32", ESK_VOXEL_SIGNED, 4},
	{"int32_t", ESK_VOXEL_SIGNED, 4},
	{"uint", ESK_VOXEL_UNSIGNED, 4},
	{"unsigned int", ESK_VOXEL_UNSIGNED, 4},
	{"uint32", ESK_VOXEL_UNSIGNED, 4},
	{"uint32_t", ESK_VOXEL_UNSIGNED, 4},
	{"longlong", ESK_VOXEL_SIGNED, 8},
	{"long long", ESK_VOXEL_SIGNED, 8},
	{"long long int", ESK_VOXEL_SIGNED, 8},
	{"signed long long", ESK_VOXEL_SIGNED, 8},
	{"signed long long int", ESK_VOXEL_SIGNED, 8},
	{"int64", ESK_VOXEL_SIGNED, 8},
	{"int64_t", ESK_VOXEL_SIGNED, 8},
	{"ulonglong", ESK_VOXEL_UNSIGNED, 8},
	{"unsigned long long", ESK_VOXEL_UNSIGNED, 8},
	{"unsigned long long int", ESK_VOXEL_UNSIGNED, 8},
	{"uint64", ESK_VOXEL_UNSIGNED, 8},
	{"uint64_t", ESK_VOXEL_UNSIGNED, 8},
	{"float", ESK_VOXEL_FLOAT, 4},
	{"double", ESK_VOXEL_FLOAT, 8},
};

static eskel_status read_type(const reading *r, eskel_error *error)
{
	const char *type = value_of(r, ESK_NRRD_TYPE);
	esk_voxel_format *voxels = &r->header->voxels;
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (strcasecmp(types[i].name, type) == 0) {
			voxels->kind = types[i].kind;
			voxels->size = types[i].size;
			return ESKEL_OK;
		}
	if (strcasecmp(type, "block") == 0)
		return esk_error_set(error, ESKEL_UNSUPPORTED, "the voxels are blocks, expected integers or reals");
	return esk_error_set(error, ESKEL_MALFORMED,
		"the NRRD header's type is \"%.60s\", expected one that NRRD defines, such as \"uint8\"", type);
}

static const struct {
	const char *name;
	bool text, compressed;
	esk_compression compression;
} encodings[] = {
	{.name = "raw"},
	{.name = "gzip", .compressed = true, .compression = ESK_COMPRESSION_GZIP},
	{.name = "gz", .compressed = true, .compression = ESK_COMPRESSION_GZIP},
	{.name = "bzip2", .compressed = true, .compression = ESK_COMPRESSION_BZIP2},
	{.name = "bz2", .compressed = true, .compression = ESK_COMPRESSION_BZIP2},
	{.name = "text", .text = true},
	{.name = "txt", .text = true},
	{.name = "ascii", .text = true},
};

static eskel_status read_encoding(const reading *r, eskel_error *error)
{
	const char *encoding = value_of(r, ESK_NRRD_ENCODING);
	for (size_t i = 0; i < sizeof encodings / sizeof *encodings; i++)
		if (strcasecmp(encodings[i].name, encoding) == 0) {
			r->header->text = encodings[i].text;
			r->header->compressed = encodings[i].compressed;
			r->header->compression = encodings[i].compression;
			return ESKEL_OK;
		}
	return esk_error_set(error, encoding[0] ? ESKEL_UNSUPPORTED : ESKEL_MALFORMED,
		"the NRRD header's encoding is \"%.60s\", expected raw, gzip, bzip2 or text", encoding);
}

static eskel_status read_endian(const reading *r, eskel_error *error)
{
	const char *endian = value_of(r, ESK_NRRD_ENDIAN);
	esk_voxel_format *voxels = &r->header->voxels;
	if (r->header->text) {
		const bool big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
		*voxels = (esk_voxel_format){.kind = ESK_VOXEL_FLOAT, .size = sizeof(double), .big_endian = big_endian};
		return ESKEL_OK;
	}
	voxels->big_endian = strcasecmp(endian, "big") == 0;
	if (!voxels->big_endian && strcasecmp(endian, "little") != 0 && (endian[0] || voxels->size > 1))
		return esk_error_set(error, ESKEL_MALFORMED,
			"the NRRD header's endian is \"%.60s\", expected little or big for voxels of %u bytes", endian,
			voxels->size);
	return ESKEL_OK;
}

static eskel_status check_skips(const reading *r, eskel_error *error)
{
	static const struct {
		esk_nrrd_field field;
		const char *name;
	} skips[] = {{ESK_NRRD_LINE_SKIP, "line skip"}, {ESK_NRRD_BYTE_SKIP, "byte skip"}};
	for (size_t i = 0; i < 2; i++)
		if (value_of(r, skips[i].field)[0] && strcmp(value_of(r, skips[i].field), "0") != 0)
			return esk_error_set(error, ESKEL_UNSUPPORTED,
				"the NRRD header's %s is \"%.60s\", expected 0: voxels right behind the header",
				skips[i].name, value_of(r, skips[i].field));
	return ESKEL_OK;
}

/* ---- axes */

static eskel_status read_dimension(reading *r, eskel_error *error)
{
	const char *dimension = value_of(r, ESK_NRRD_DIMENSION);
	if (strcmp(dimension, "3") != 0 && strcmp(dimension, "4") != 0)
		return esk_error_set(error, dimension[0] ? ESKEL_UNSUPPORTED : ESKEL_MALFORMED,
			"the NRRD header's dimension is \"%.60s\", expected 3, or 4 with one axis that is not in space",
			dimension);
	r->axes.count = dimension[0] - '0';
	return ESKEL_OK;
}

static bool is_kind_in_space(esk_nrrd_span kind)
{
	static const char *const kinds[] = {"domain", "space", "none", "???"};
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (esk_nrrd_span_is(kind, kinds[i]))
			return true;
	return false;
}

/* Which axes are in space: neither their kind nor their direction says otherwise. */
static eskel_status find_axes(reading *r, bool in_space[ESK_NRRD_AXES_MOST], eskel_error *error)
{
	const char *kinds = value_of(r, ESK_NRRD_KINDS), *directions = value_of(r, ESK_NRRD_SPACE_DIRECTIONS);
	const bool has_kinds = kinds[0] != 0, has_directions = directions[0] != 0;
	for (int a = 0; a < r->axes.count; a++) {
		esk_nrrd_span kind;
		double direction[3];
		bool none = false;
		if (has_kinds && !esk_nrrd_read_word(&kinds, &kind))
			return esk_nrrd_refuse_list(&r->axes, ESK_NRRD_KINDS, "kinds", "words", r->axes.count, error);
		if (has_directions && !esk_nrrd_read_vector(&directions, direction, &none))
			return esk_nrrd_refuse_list(&r->axes, ESK_NRRD_SPACE_DIRECTIONS, "space directions",
				"vectors (x,y,z) or none", r->axes.count, error);
		in_space[a] = !none && (!has_kinds || is_kind_in_space(kind));
	}
	if (*kinds)
		return esk_nrrd_refuse_list(&r->axes, ESK_NRRD_KINDS, "kinds", "words", r->axes.count, error);
	if (*directions)
		return esk_nrrd_refuse_list(&r->axes, ESK_NRRD_SPACE_DIRECTIONS, "space directions",
			"vectors (x,y,z) or none", r->axes.count, error);
	return ESKEL_OK;
}

static eskel_status check_size(int axis, double size, eskel_error *error)
{
	if (size != rint(size) || !(size >= 1))
		return esk_error_set(error, ESKEL_MALFORMED,
			"the NRRD header's size of axis %d is %g, expected a whole number from 1", axis, size);
	if (size > longest_axis)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the NRRD header's size of axis %d is %g, expected at most %d", axis, size, longest_axis);
	return ESKEL_OK;
}

static eskel_status refuse_axis(int axis, double size, eskel_error *error)
{
	return esk_error_set(error, ESKEL_UNSUPPORTED,
		"axis %d of the NRRD file is not in space and has %g samples, expected 1, or segments described in "
		"layers along the first axis",
		axis, size);
}

/* The first axis may be one of layers. */
static eskel_status take_other_axis(reading *r, int axis, double size, eskel_error *error)
{
	if (axis > 0 && size > 1)
		return refuse_axis(axis, size, error);
	if (size > ESK_LAYERS_MOST)
		return esk_error_set(error, ESKEL_TOO_LARGE, "the NRRD file has %g layers, expected at most %d", size,
			ESK_LAYERS_MOST);
	if (axis == 0)
		r->header->layer_count = (uint32_t)size;
	return ESKEL_OK;
}

static eskel_status read_axes(reading *r, eskel_error *error)
{
	double sizes[ESK_NRRD_AXES_MOST] = {0};
	bool in_space[ESK_NRRD_AXES_MOST] = {false};
	eskel_status status = read_dimension(r, error);
	if (status == ESKEL_OK)
		status = find_axes(r, in_space, error);
	if (status == ESKEL_OK)
		status = esk_nrrd_read_numbers(&r->axes, ESK_NRRD_SIZES, "sizes", sizes, error);
	int found = 0;
	for (int a = 0; a < r->axes.count && status == ESKEL_OK; a++) {
		status = check_size(a, sizes[a], error);
		if (status == ESKEL_OK && !in_space[a])
			status = take_other_axis(r, a, sizes[a], error);
		if (status == ESKEL_OK && in_space[a] && found < 3) {
			r->axes.in_space[found] = a;
			r->header->info.extent[found] = (uint32_t)sizes[a];
		}
		found += in_space[a];
	}
	if (status == ESKEL_OK && found != 3)
		status = esk_error_set(error, ESKEL_UNSUPPORTED,
			"%d of the %d axes of the NRRD file are in space, expected 3", found, r->axes.count);
	return status;
}

/* ---- the whole */

static eskel_status read_fields(reading *r, esk_nrrd_span text, eskel_error *error)
{
	esk_nrrd_fields fields;
	eskel_status status = esk_nrrd_fields_read(text, &fields, error);
	r->axes.fields = &fields;
	if (status == ESKEL_OK)
		status = read_type(r, error);
	if (status == ESKEL_OK)
		status = read_encoding(r, error);
	if (status == ESKEL_OK)
		status = read_endian(r, error);
	if (status == ESKEL_OK)
		status = check_skips(r, error);
	if (status == ESKEL_OK)
		status = read_axes(r, error);
	if (status == ESKEL_OK)
		status = esk_nrrd_read_geometry(&r->axes, &r->header->info, error);
	if (status == ESKEL_OK)
		status = esk_nrrd_segments_read(text, r->header->layer_count, &r->header->segments, error);
	if (status == ESKEL_OK && r->header->layer_count > 1 && r->header->segments.count == 0)
		status = refuse_axis(0, r->header->layer_count, error);
	return status;
}

static eskel_status check_magic(const uint8_t *bytes, eskel_error *error)
{
	const uint8_t version = bytes[magic_size - 1];
	if (memcmp(bytes, "NRRD000", magic_size - 1) == 0 && version >= '1' && version <= '5' &&
		(bytes[magic_size] == '\n' || bytes[magic_size] == '\r'))
		return ESKEL_OK;
	char shown[magic_size + 1];
	esk_nrrd_print((esk_nrrd_span){(const char *)bytes, magic_size}, shown, sizeof shown);
	return esk_error_set(error, ESKEL_UNSUPPORTED,
		"the first line begins with \"%s\", expected one of NRRD0001 to NRRD0005 alone", shown);
}

/* The line that the last byte ends. */
static esk_nrrd_span last_line(esk_nrrd_span text)
{
	size_t begin = text.size - 1;
	while (begin > 0 && text.text[begin - 1] != '\n')
		begin--;
	esk_nrrd_span rest = {text.text + begin, text.size - begin}, line = rest;
	esk_nrrd_next_line(&rest, &line);
	return line;
}

static eskel_status refuse_data_file(esk_nrrd_span value, eskel_error *error)
{
	char shown[80];
	esk_nrrd_print(value, shown, sizeof shown);
	return esk_error_set(error, ESKEL_UNSUPPORTED,
		"the NRRD header names voxels in another file (data file: %s), expected them behind the header in one "
		"file",
		shown);
}

eskel_status esk_nrrd_read_header(
	const uint8_t *bytes, size_t size, size_t *needed, esk_volume_header *header, eskel_error *error)
{
	if (memcmp(bytes, "NRRD", 4) != 0)
		return ESKEL_NOT_VOLUME;
	*needed = size > magic_size ? size : magic_size + 1;
	eskel_status status = size > magic_size ? check_magic(bytes, error) : ESKEL_OK;
	if (status != ESKEL_OK || size <= magic_size)
		return status;
	const esk_nrrd_span text = {(const char *)bytes, size};
	const bool line_ended = bytes[size - 1] == '\n';
	const esk_nrrd_span line = line_ended ? last_line(text) : text;
	esk_nrrd_span name, value;
	if (line_ended && esk_nrrd_split(line, &name, &value) == ESK_NRRD_FIELD &&
		esk_nrrd_field_named(name) == ESK_NRRD_DATA_FILE)
		return refuse_data_file(value, error);
	if (!line_ended || line.size > 0) {
		*needed = largest_header;
		return size < largest_header
			       ? ESKEL_OK
			       : esk_error_set(error, ESKEL_TOO_LARGE,
					 "the NRRD header has more than %d bytes, expected an empty line before",
					 largest_header);
	}
	esk_volume_header h = {.info.format = "NRRD", .layer_count = 1, .data_offset = size};
	reading r = {.header = &h};
	status = read_fields(&r, text, error);
	if (status == ESKEL_OK)
		*header = h;
	return status;
}
