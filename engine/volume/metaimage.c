/* The header of MetaImage files with attached voxels (.mha): lines "Key = value", the last of them ElementDataFile, and the
 * voxels right after it.
 *
 * What ITK's MetaIO library reads and writes defines the format. As there, the three numbers of TransformMatrix for each
 * index axis are that axis's direction, positions are in LPS (here turned to RAS), the centre of rotation and
 * AnatomicalOrientation change nothing, and the sizes of C's types are those of 32-bit machines. CompressedDataSize is not
 * needed, because a zlib stream tells its end and its checksum.
 *
 * Stricter than ITK: voxels in any other file are refused whatever names them, voxels must end with the file, and a field
 * may be given twice, under one or several of its names, only if it says the same.
 */
#include "error.h"
#include "volume_format.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Comments are all that grows: ITK writes about 500 bytes. */
enum { largest_header = 65536, longest_axis = 65535 };

/* Nine numbers of 17 digits with sign, point and exponent take 225 bytes. */
enum { longest_value = 400 };

static const double largest_offset = 16 << 20;

typedef enum {
	OBJECT_TYPE,
	DIMENSIONS,
	EXTENT,
	CHANNELS,
	TYPE,
	BINARY,
	BIG_ENDIAN_BYTES,
	COMPRESSED,
	HEADER_SIZE,
	SPACING,
	VOXEL_SIZE, /* spacing where there is none */
	POSITION,
	DIRECTIONS,
	DATA_FILE,
	FIELDS
} field;

static const struct {
	const char *key;
	field field;
} keys[] = {
	{"ObjectType", OBJECT_TYPE},
	{"NDims", DIMENSIONS},
	{"DimSize", EXTENT},
	{"ElementNumberOfChannels", CHANNELS},
	{"ElementType", TYPE},
	{"BinaryData", BINARY},
	{"BinaryDataByteOrderMSB", BIG_ENDIAN_BYTES},
	{"ElementByteOrderMSB", BIG_ENDIAN_BYTES},
	{"CompressedData", COMPRESSED},
	{"HeaderSize", HEADER_SIZE},
	{"ElementSpacing", SPACING},
	{"ElementSize", VOXEL_SIZE},
	{"Offset", POSITION},
	{"Position", POSITION},
	{"Origin", POSITION},
	{"TransformMatrix", DIRECTIONS},
	{"Rotation", DIRECTIONS},
	{"Orientation", DIRECTIONS},
	{"ElementDataFile", DATA_FILE},
};

typedef struct {
	const char *key; /* NULL: not said */
	char text[longest_value + 1];
} value;

typedef struct {
	value values[FIELDS];
	locale_t c_locale; /* in which numbers have a point */
} header_fields;

typedef struct {
	const uint8_t *bytes;
	size_t size;
} span;

static bool is_blank(uint8_t byte)
{
	return byte == ' ' || byte == '\t' || byte == '\r';
}

static span trimmed(span s)
{
	for (; s.size > 0 && is_blank(s.bytes[0]); s.size--)
		s.bytes++;
	while (s.size > 0 && is_blank(s.bytes[s.size - 1]))
		s.size--;
	return s;
}

/* At most longest_value bytes, a tab as a space and what is no printable ASCII as '?', so that sentences can show it. */
static void copy_text(span s, char text[longest_value + 1])
{
	size_t size = s.size < longest_value ? s.size : longest_value;
	for (size_t i = 0; i < size; i++)
		text[i] = is_blank(s.bytes[i]) ? ' ' : s.bytes[i] > ' ' && s.bytes[i] <= '~' ? (char)s.bytes[i] : '?';
	text[size] = '\0';
}

static eskel_status set_value(header_fields *h, size_t key, span s, eskel_error *error)
{
	value read = {.key = keys[key].key}, *kept = &h->values[keys[key].field];
	if (s.size > longest_value)
		return esk_error_set(error, ESKEL_MALFORMED, "%s has a value of %zu bytes, expected at most %d",
			read.key, s.size, longest_value);
	copy_text(s, read.text);
	if (kept->key && strcmp(kept->text, read.text) != 0)
		return esk_error_set(error, ESKEL_MALFORMED, "the header says %s = %.60s and %s = %.60s", kept->key,
			kept->text, read.key, read.text);
	*kept = read;
	return ESKEL_OK;
}

static eskel_status read_line(header_fields *h, span line, unsigned number, eskel_error *error)
{
	line = trimmed(line);
	if (line.size == 0)
		return ESKEL_OK;
	const uint8_t *equals = memchr(line.bytes, '=', line.size);
	if (!equals) {
		char text[longest_value + 1];
		copy_text(line, text);
		return esk_error_set(error, ESKEL_MALFORMED, "line %u of the header is \"%.60s\", expected Key = value",
			number, text);
	}
	size_t before = (size_t)(equals - line.bytes);
	span key = trimmed((span){line.bytes, before});
	span said = trimmed((span){equals + 1, line.size - before - 1});
	for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++)
		if (strlen(keys[k].key) == key.size && memcmp(keys[k].key, key.bytes, key.size) == 0)
			return set_value(h, k, said, error);
	return ESKEL_OK;
}

static eskel_status read_lines(header_fields *h, const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	unsigned number = 1;
	for (size_t at = 0; at < size && status == ESKEL_OK; number++) {
		const uint8_t *end = memchr(bytes + at, '\n', size - at);
		size_t length = end ? (size_t)(end - bytes) - at : size - at;
		status = read_line(h, (span){bytes + at, length}, number, error);
		at += length + 1;
	}
	return status;
}

/* Decimal numbers with blanks between them. */
static bool parse_numbers(const header_fields *h, const char *text, int count, double *numbers)
{
	for (int i = 0; i < count; i++) {
		char *end;
		text += strspn(text, " ");
		size_t length = strspn(text, "0123456789+-.eE");
		numbers[i] = strtod_l(text, &end, h->c_locale);
		if (length == 0 || end != text + length)
			return false;
		text = end;
	}
	return *text == '\0';
}

/* Leaves numbers as they are where the field is not said. */
static eskel_status read_numbers(const header_fields *h, field f, int count, double *numbers, eskel_error *error)
{
	const value *v = &h->values[f];
	double read[9];
	if (!v->key)
		return ESKEL_OK;
	if (!parse_numbers(h, v->text, count, read))
		return esk_error_set(error, ESKEL_MALFORMED, "%s is \"%.80s\", expected %d number%s", v->key, v->text,
			count, count > 1 ? "s" : "");
	memcpy(numbers, read, (size_t)count * sizeof *read);
	return ESKEL_OK;
}

static eskel_status read_flag(const header_fields *h, field f, bool *flag, eskel_error *error)
{
	static const char *const words[] = {"True", "T", "1", "False", "F", "0"};
	const value *v = &h->values[f];
	if (!v->key)
		return ESKEL_OK;
	for (int i = 0; i < 6; i++)
		if (strcasecmp(v->text, words[i]) == 0) {
			*flag = i < 3;
			return ESKEL_OK;
		}
	return esk_error_set(error, ESKEL_MALFORMED, "%s is \"%.60s\", expected True or False", v->key, v->text);
}

static eskel_status check_kind(const header_fields *h, eskel_error *error)
{
	const value *object = &h->values[OBJECT_TYPE], *data = &h->values[DATA_FILE];
	double dimensions = 0, channels = 1;
	bool binary = true;
	if (strcasecmp(data->text, "LOCAL") != 0)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the header names voxels in another file (ElementDataFile is \"%.60s\"), expected LOCAL",
			data->text);
	if (object->key && strcasecmp(object->text, "Image") != 0)
		return esk_error_set(error, ESKEL_UNSUPPORTED, "ObjectType is \"%.60s\", expected Image", object->text);
	eskel_status status = read_numbers(h, DIMENSIONS, 1, &dimensions, error);
	if (status == ESKEL_OK)
		status = read_numbers(h, CHANNELS, 1, &channels, error);
	if (status == ESKEL_OK)
		status = read_flag(h, BINARY, &binary, error);
	if (status != ESKEL_OK)
		return status;
	if (dimensions != 3)
		return esk_error_set(error, ESKEL_UNSUPPORTED, "NDims is %g, expected 3", dimensions);
	if (channels != 1)
		return esk_error_set(error, ESKEL_UNSUPPORTED, "ElementNumberOfChannels is %g, expected 1", channels);
	if (!binary)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the voxels are written as text (BinaryData is False), expected binary voxels");
	return ESKEL_OK;
}

static eskel_status read_extent(const header_fields *h, uint32_t extent[3], eskel_error *error)
{
	double lengths[3];
	if (!h->values[EXTENT].key)
		return esk_error_set(error, ESKEL_MALFORMED, "the header has no DimSize");
	eskel_status status = read_numbers(h, EXTENT, 3, lengths, error);
	for (int a = 0; a < 3 && status == ESKEL_OK; a++) {
		if (!(lengths[a] >= 1) || (lengths[a] <= longest_axis && lengths[a] != rint(lengths[a])))
			return esk_error_set(error, ESKEL_MALFORMED,
				"DimSize[%d] is %g, expected a whole number from 1", a, lengths[a]);
		if (lengths[a] > longest_axis)
			return esk_error_set(error, ESKEL_TOO_LARGE, "DimSize[%d] is %.10g, expected at most %d", a,
				lengths[a], longest_axis);
		extent[a] = (uint32_t)lengths[a];
	}
	return status;
}

static eskel_status read_type(const header_fields *h, esk_voxel_format *voxels, eskel_error *error)
{
	static const struct {
		const char *name;
		esk_voxel_kind kind;
		unsigned size;
	} types[] = {
		{"MET_CHAR", ESK_VOXEL_SIGNED, 1},
		{"MET_UCHAR", ESK_VOXEL_UNSIGNED, 1},
		{"MET_SHORT", ESK_VOXEL_SIGNED, 2},
		{"MET_USHORT", ESK_VOXEL_UNSIGNED, 2},
		{"MET_INT", ESK_VOXEL_SIGNED, 4},
		{"MET_UINT", ESK_VOXEL_UNSIGNED, 4},
		{"MET_LONG", ESK_VOXEL_SIGNED, 4},
		{"MET_ULONG", ESK_VOXEL_UNSIGNED, 4},
		{"MET_LONG_LONG", ESK_VOXEL_SIGNED, 8},
		{"MET_ULONG_LONG", ESK_VOXEL_UNSIGNED, 8},
		{"MET_FLOAT", ESK_VOXEL_FLOAT, 4},
		{"MET_DOUBLE", ESK_VOXEL_FLOAT, 8},
	};
	const value *type = &h->values[TYPE];
	if (!type->key)
		return esk_error_set(error, ESKEL_MALFORMED, "the header has no ElementType");
	for (size_t t = 0; t < sizeof types / sizeof types[0]; t++)
		if (strcmp(type->text, types[t].name) == 0) {
			voxels->kind = types[t].kind;
			voxels->size = types[t].size;
			return read_flag(h, BIG_ENDIAN_BYTES, &voxels->big_endian, error);
		}
	return esk_error_set(error, ESKEL_UNSUPPORTED,
		"ElementType is \"%.60s\", expected integers or reals, MET_CHAR to MET_DOUBLE", type->text);
}

/* HeaderSize -1 says that the voxels are the last bytes of the file. They must be anyway, so it is what 0 is. */
static eskel_status read_offset(const header_fields *h, size_t header_size, uint64_t *offset, eskel_error *error)
{
	double said = 0;
	eskel_status status = read_numbers(h, HEADER_SIZE, 1, &said, error);
	if (status != ESKEL_OK)
		return status;
	bool after_header = said == 0 || said == -1;
	if (!after_header && !(said >= (double)header_size && said <= largest_offset && said == rint(said)))
		return esk_error_set(error, ESKEL_MALFORMED,
			"HeaderSize is %g, expected -1, 0 or the header's %zu bytes to %.0f", said, header_size,
			largest_offset);
	*offset = after_header ? header_size : (uint64_t)said;
	return ESKEL_OK;
}

static eskel_status read_spacing(const header_fields *h, double spacing[3], eskel_volume_info *info, eskel_error *error)
{
	field f = h->values[SPACING].key ? SPACING : VOXEL_SIZE;
	const char *key = h->values[f].key;
	eskel_status status = read_numbers(h, f, 3, spacing, error);
	for (int a = 0; a < 3 && status == ESKEL_OK; a++)
		if (!(spacing[a] > 0))
			return esk_error_set(error, ESKEL_BAD_GEOMETRY, "%s[%d] is %g, expected a positive spacing",
				key, a, spacing[a]);
	if (!key)
		eskel_volume_warn(
			info, ESKEL_WARNING_UNIT_ASSUMED, "the file has no ElementSpacing; voxels of 1 mm are assumed");
	return status;
}

static eskel_status read_affine(const header_fields *h, eskel_volume_info *info, eskel_error *error)
{
	double spacing[3] = {1, 1, 1}, position[3] = {0}, directions[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
	eskel_status status = read_spacing(h, spacing, info, error);
	if (status == ESKEL_OK)
		status = read_numbers(h, POSITION, 3, position, error);
	if (status == ESKEL_OK)
		status = read_numbers(h, DIRECTIONS, 9, directions, error);
	if (status != ESKEL_OK)
		return status;
	if (!h->values[DIRECTIONS].key)
		eskel_volume_warn(info, ESKEL_WARNING_NO_ORIENTATION,
			"the file has no TransformMatrix: its axes are taken as left, back and head, so left and right "
			"may be exchanged");
	for (int r = 0; r < 3; r++) {
		double *row = info->affine.m[r];
		for (int c = 0; c < 3; c++)
			row[c] = directions[3 * c + r] * spacing[c];
		row[3] = position[r];
		for (int c = 0; c < 4 && r < 2; c++)
			row[c] = 0 - row[c]; /* LPS to RAS, without -0 */
	}
	return eskel_affine_check(&info->affine, error);
}

static eskel_status read_fields(
	header_fields *h, const uint8_t *bytes, size_t size, esk_volume_header *header, eskel_error *error)
{
	eskel_status status = read_lines(h, bytes, size, error);
	if (status == ESKEL_OK)
		status = check_kind(h, error);
	if (status == ESKEL_OK)
		status = read_extent(h, header->info.extent, error);
	if (status == ESKEL_OK)
		status = read_type(h, &header->voxels, error);
	if (status == ESKEL_OK)
		status = read_flag(h, COMPRESSED, &header->compressed, error);
	if (status == ESKEL_OK)
		status = read_offset(h, size, &header->data_offset, error);
	if (status == ESKEL_OK)
		status = read_affine(h, &header->info, error);
	return status;
}

/* Whether the last of the bytes ends the line that ends the header. */
static bool header_ends(const uint8_t *bytes, size_t size)
{
	static const char key[] = "ElementDataFile";
	if (bytes[size - 1] != '\n')
		return false;
	const uint8_t *before = memrchr(bytes, '\n', size - 1), *first = before ? before + 1 : bytes;
	span line = trimmed((span){first, (size_t)(bytes + size - first) - 1});
	return line.size >= sizeof key - 1 && memcmp(line.bytes, key, sizeof key - 1) == 0;
}

/* Whether the bytes begin as ITK and those who write headers by hand begin; *needed grows where it is too early to say. */
static bool begins_as_metaimage(const uint8_t *bytes, size_t size, size_t *needed)
{
	static const char *const beginnings[] = {"ObjectType", "NDims", "Comment ="};
	for (size_t i = 0; i < sizeof beginnings / sizeof beginnings[0]; i++) {
		size_t length = strlen(beginnings[i]);
		if (memcmp(bytes, beginnings[i], size < length ? size : length) != 0)
			continue;
		*needed = length;
		return true;
	}
	return false;
}

eskel_status esk_metaimage_read_header(
	const uint8_t *bytes, size_t size, size_t *needed, esk_volume_header *header, eskel_error *error)
{
	if (!begins_as_metaimage(bytes, size, needed))
		return ESKEL_NOT_VOLUME;
	if (size < *needed)
		return ESKEL_OK;
	const bool ended = header_ends(bytes, size); /* nothing else tells how long the header is */
	*needed = ended ? size : largest_header;
	if (!ended && size >= largest_header)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the first %d bytes of the header have no line ElementDataFile = LOCAL", largest_header);
	if (size < *needed)
		return ESKEL_OK;
	esk_volume_header read = {.info.format = "MetaImage", .layer_count = 1, .compression = ESK_COMPRESSION_ZLIB};
	header_fields h = {.c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0)};
	if (!h.c_locale)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out in the header");
	eskel_status status = read_fields(&h, bytes, size, &read, error);
	freelocale(h.c_locale);
	if (status == ESKEL_OK)
		*header = read;
	return status;
}
