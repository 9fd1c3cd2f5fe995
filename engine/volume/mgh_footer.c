/* The footer of MGH files: five numbers of the scan, then tags up to the tag 0 or the end of the file. Any of it may be
 * missing. All numbers are big-endian; a text is its size, with the terminating 0, and its bytes.
 *
 * A tag is its number, the 64-bit size of its content, and the content, which is passed over: command lines and file names
 * may hold patient data. The oldest tags have no size; among them is the colour table, in one of two forms:
 *
 *   count > 0, name of the table's file, for the labels 0 ... count - 1: name, red, green, blue, transparency
 *   -2, largest label + 1, name of the table's file, count, for each: label, name, red, green, blue, transparency
 *
 * The others without a size are of surfaces and warps; nothing is read behind one.
 */
#include "mgh_footer.h"

#include "byte_order.h"
#include "error.h"
#include "freesurfer_names.h"

#include <string.h>

enum { scan_size = 20, colour_size = 16 };

enum {
	TAG_END = 0,
	TAG_COLOUR_TABLE = 1,
	TAG_USE_REAL_RAS = 2,
	TAG_WARP_GEOMETRY = 10,
	TAG_WARP_TYPE = 11,
	TAG_WARP_LABELS = 12,
	TAG_SURFACE_GEOMETRY = 20,
	TAG_OLD_TRANSFORM = 30,
};

typedef struct {
	const uint8_t *at;
	size_t left;
} rest;

/* ---- taking from the rest; false, with nothing taken, when it is too short */

static bool skip(rest *r, uint64_t size)
{
	if (size > r->left)
		return false;
	r->at += size;
	r->left -= (size_t)size;
	return true;
}

static bool take_number(rest *r, int32_t *number)
{
	const uint8_t *at = r->at;
	if (!skip(r, 4))
		return false;
	*number = (int32_t)esk_byte_order_signed(at, 4, true);
	return true;
}

static bool take_text(rest *r, const char **text, size_t *size)
{
	int32_t said;
	if (!take_number(r, &said) || said < 0)
		return false;
	*text = (const char *)r->at;
	if (!skip(r, (uint64_t)said))
		return false;
	*size = strnlen(*text, (size_t)said);
	return true;
}

static bool skip_sized(rest *r)
{
	const uint8_t *at = r->at;
	return skip(r, 8) && skip(r, esk_byte_order_unsigned(at, 8, true));
}

/* ---- names */

static eskel_status take_colour_table(rest *r, esk_segments *segments)
{
	enum { numbered = -2 };
	int32_t form, count, label;
	const char *name;
	size_t size;
	if (!take_number(r, &form) || (form <= 0 && form != numbered))
		return ESKEL_MALFORMED;
	if ((form == numbered && !take_number(r, &count)) || !take_text(r, &name, &size))
		return ESKEL_MALFORMED;
	count = form;
	if (form == numbered && !take_number(r, &count))
		return ESKEL_MALFORMED;
	eskel_status status = ESKEL_OK;
	for (int32_t i = 0; i < count && status == ESKEL_OK; i++) {
		label = i;
		if ((form == numbered && !take_number(r, &label)) || !take_text(r, &name, &size) ||
			!skip(r, colour_size))
			return ESKEL_MALFORMED;
		status = esk_segments_add_name(segments, label, name, size);
	}
	return status;
}

static eskel_status take_tags(rest r, esk_segments *segments)
{
	eskel_status status = ESKEL_OK;
	int32_t tag;
	if (!skip(&r, scan_size))
		return ESKEL_OK;
	while (status == ESKEL_OK && take_number(&r, &tag)) {
		switch (tag) {
		case TAG_COLOUR_TABLE:
			status = take_colour_table(&r, segments);
			break;
		case TAG_END:
		case TAG_USE_REAL_RAS:
		case TAG_WARP_GEOMETRY:
		case TAG_WARP_TYPE:
		case TAG_WARP_LABELS:
		case TAG_SURFACE_GEOMETRY:
		case TAG_OLD_TRANSFORM:
			return ESKEL_OK;
		default:
			status = skip_sized(&r) ? ESKEL_OK : ESKEL_MALFORMED;
		}
	}
	return status;
}

/* aseg.mgz has no colour table: its labels mean what FreeSurfer's table says. */
static eskel_status assume_names(const esk_label_table *labels, esk_volume_header *header)
{
	eskel_status status = ESKEL_OK;
	for (size_t i = 0; i < labels->count && status == ESKEL_OK; i++) {
		const char *name = esk_freesurfer_name(labels->items[i].label);
		if (name)
			status = esk_segments_add_name(&header->segments, labels->items[i].label, name, strlen(name));
	}
	if (status == ESKEL_OK && header->segments.count > 0)
		eskel_volume_warn(&header->info, ESKEL_WARNING_NAMES_ASSUMED,
			"the file has no colour table; labels have the names that they have in FreeSurfer's aseg.mgz");
	return status;
}

eskel_status esk_mgh_footer_read(
	const uint8_t *bytes, size_t size, const esk_label_table *labels, esk_volume_header *header, eskel_error *error)
{
	eskel_status status = take_tags((rest){bytes, size}, &header->segments);
	if (status == ESKEL_OK && header->segments.count == 0)
		status = assume_names(labels, header);
	if (status == ESKEL_NO_MEMORY)
		return esk_error_set(error, status, "memory ran out for the names of labels");
	if (status == ESKEL_MALFORMED)
		eskel_volume_warn(&header->info, ESKEL_WARNING_NAMES_INCOMPLETE,
			"what follows the voxels breaks off or is damaged; %zu label names were read",
			header->segments.count);
	return ESKEL_OK;
}
