/* What a frame's own functional groups do not say is what is shared by all. */
#include "segmentation.h"

#include "attributes.h"
#include "dicom_text.h"
#include "refusal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { most_segments = 4096, most_frames = 1 << 18 };
/* mm; what is farther away than any scanner reaches is an error, and sums of it would lose digits. */
static const double farthest = 1e6;

/* ---- values */

static bool wants(void *reader, const esk_element_place *place)
{
	esk_attribute found;
	(void)reader;
	return esk_attribute_find(place, &found);
}

static eskel_status refuse_value(const esk_element_place *place, const char *expected, eskel_error *error)
{
	return esk_refuse(error, ESKEL_MALFORMED, "DICOM element (%04x,%04x) is no %s", place->tag >> 16,
		place->tag & 0xffff, expected);
}

static bool take_number(const uint8_t *bytes, size_t size, uint16_t *number)
{
	if (size == 2)
		*number = (uint16_t)(bytes[0] | bytes[1] << 8);
	return size == 2;
}

static eskel_status take_class(const uint8_t *bytes, size_t size, esk_segmentation *s, eskel_error *error)
{
	static const char *const classes[] = {"1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7"};
	char class[65];
	esk_dicom_text(bytes, size, "", class, sizeof class);
	for (size_t i = 0; i < 2; i++)
		s->is_segmentation = s->is_segmentation || strcmp(class, classes[i]) == 0;
	return s->is_segmentation ? ESKEL_OK
				  : esk_refuse(error, ESKEL_UNSUPPORTED,
					    "the DICOM file is of class %s, expected a segmentation, %s or %s", class,
					    classes[0], classes[1]);
}

static eskel_status take_type(const uint8_t *bytes, size_t size, esk_segmentation *s, eskel_error *error)
{
	static const char *const types[] = {
		[ESK_BINARY] = "BINARY", [ESK_FRACTIONAL] = "FRACTIONAL", [ESK_LABEL_MAP] = "LABELMAP"};
	char type[17];
	esk_dicom_text(bytes, size, "", type, sizeof type);
	for (unsigned i = 0; i < sizeof types / sizeof *types; i++)
		if (strcmp(type, types[i]) == 0) {
			s->type = (esk_segmentation_type)i;
			return ESKEL_OK;
		}
	return esk_refuse(error, ESKEL_UNSUPPORTED,
		"the segmentation is of type \"%s\", expected BINARY, FRACTIONAL or LABELMAP", type);
}

static bool take_frame_count(const uint8_t *bytes, size_t size, uint32_t *count)
{
	double number;
	if (!esk_dicom_decimals(bytes, size, &number, 1) || !(number >= 0 && number <= UINT32_MAX))
		return false;
	*count = (uint32_t)number;
	return *count == number;
}

static void take_side(const uint8_t *bytes, size_t size, bool value, esk_coded_side *side)
{
	/* SNOMED RT and SNOMED CT (PS3.16, CID 244) */
	static const struct {
		esk_coded_side side;
		const char *meaning, *values[2];
	} sides[] = {
		{ESK_CODED_LEFT, "left", {"G-A101", "7771000"}}, {ESK_CODED_RIGHT, "right", {"G-A100", "24028007"}}};
	char text[33];
	esk_dicom_text(bytes, size, "", text, sizeof text);
	for (size_t i = 0; i < 2 && *side == ESK_CODED_NOTHING; i++)
		if (value ? strcmp(text, sides[i].values[0]) == 0 || strcmp(text, sides[i].values[1]) == 0
			  : strcasecmp(text, sides[i].meaning) == 0)
			*side = sides[i].side;
}

static eskel_status take_of_segment(esk_segmentation *s, esk_attribute which, const esk_element_place *place,
	const uint8_t *bytes, size_t size, eskel_error *error)
{
	esk_dicom_segment *segment = &s->segments[s->segment_count - 1];
	char *text = which == ESK_LABEL ? segment->label : which == ESK_TYPE_MEANING ? segment->type : segment->region;
	switch (which) {
	case ESK_NUMBER:
		return take_number(bytes, size, &segment->number) ? ESKEL_OK : refuse_value(place, "number", error);
	case ESK_TYPE_SIDE_VALUE:
	case ESK_TYPE_SIDE_MEANING:
		take_side(bytes, size, which == ESK_TYPE_SIDE_VALUE, &segment->type_side);
		break;
	case ESK_REGION_SIDE_VALUE:
	case ESK_REGION_SIDE_MEANING:
		take_side(bytes, size, which == ESK_REGION_SIDE_VALUE, &segment->region_side);
		break;
	default:
		if (!text[0]) /* of several codes the first is the main one */
			esk_dicom_text(bytes, size, s->character_set, text, ESK_SEGMENT_TEXT);
	}
	return ESKEL_OK;
}

static bool take_of_plane(esk_plane *plane, esk_attribute which, const uint8_t *bytes, size_t size)
{
	switch (which) {
	case ESK_POSITION:
		return plane->positioned = esk_dicom_decimals(bytes, size, plane->position, 3);
	case ESK_ORIENTATION:
		return plane->oriented = esk_dicom_decimals(bytes, size, plane->orientation, 6);
	case ESK_SPACING:
		return plane->spaced = esk_dicom_decimals(bytes, size, plane->spacing, 2);
	case ESK_THICKNESS: /* these two may be empty */
		return size == 0 || esk_dicom_decimals(bytes, size, &plane->thickness, 1);
	case ESK_BETWEEN:
		return size == 0 || esk_dicom_decimals(bytes, size, &plane->between, 1);
	default:
		return take_number(bytes, size, &plane->segment);
	}
}

static eskel_status take_of_set(esk_segmentation *s, esk_attribute which, const esk_element_place *place,
	const uint8_t *bytes, size_t size, eskel_error *error)
{
	bool good = true;
	switch (which) {
	case ESK_CHARACTER_SET:
		esk_dicom_text(bytes, size, "", s->character_set, sizeof s->character_set);
		break;
	case ESK_CLASS:
		return take_class(bytes, size, s, error);
	case ESK_TYPE:
		return take_type(bytes, size, s, error);
	case ESK_FRAME_COUNT:
		good = take_frame_count(bytes, size, &s->frames_announced);
		break;
	default:
		good = take_number(bytes, size,
			which == ESK_SAMPLES      ? &s->samples
			: which == ESK_ROWS       ? &s->rows
			: which == ESK_COLUMNS    ? &s->columns
			: which == ESK_BITS       ? &s->bits
			: which == ESK_BACKGROUND ? &s->background
						  : &s->most_fraction);
	}
	return good ? ESKEL_OK : refuse_value(place, "number", error);
}

static eskel_status take_value(
	void *reader, const esk_element_place *place, const uint8_t *bytes, size_t size, eskel_error *error)
{
	esk_segmentation *s = reader;
	esk_attribute which;
	if (!esk_attribute_find(place, &which))
		return ESKEL_OK;
	if (place->root == 0)
		return take_of_set(s, which, place, bytes, size, error);
	if (place->root == ESK_SEGMENTS)
		return take_of_segment(s, which, place, bytes, size, error);
	esk_plane *plane = place->root == ESK_SHARED_GROUPS ? &s->shared : &s->current;
	return take_of_plane(plane, which, bytes, size) ? ESKEL_OK : refuse_value(place, "list of numbers", error);
}

/* ---- items */

/* Room for one more of size bytes. */
static bool reserve(void **items, size_t *capacity, size_t count, size_t size)
{
	if (count < *capacity)
		return true;
	const size_t more = *capacity + *capacity / 2 + 16;
	void *moved = realloc(*items, more * size); /* at most 2^18 frames */
	if (!moved)
		return false;
	*items = moved;
	*capacity = more;
	return true;
}

static eskel_status begin_segment(esk_segmentation *s, eskel_error *error)
{
	void *items = s->segments;
	if (s->segment_count == most_segments)
		return esk_refuse(error, ESKEL_TOO_LARGE, "the segmentation has more than %d segments", most_segments);
	if (!reserve(&items, &s->segment_capacity, s->segment_count, sizeof *s->segments))
		return esk_refuse(error, ESKEL_NO_MEMORY, "memory ran out for %zu segments", s->segment_count + 1);
	s->segments = items;
	s->segments[s->segment_count++] = (esk_dicom_segment){0};
	return ESKEL_OK;
}

static eskel_status end_segment(const esk_segmentation *s, eskel_error *error)
{
	const esk_dicom_segment *last = &s->segments[s->segment_count - 1];
	if (last->number == 0 && s->type != ESK_LABEL_MAP) /* there it is the background */
		return esk_refuse(error, ESKEL_MALFORMED, "segment %zu of the segmentation has no number from 1 on",
			s->segment_count);
	for (const esk_dicom_segment *other = s->segments; other < last; other++)
		if (other->number == last->number)
			return esk_refuse(error, ESKEL_MALFORMED, "two segments have the number %d", (int)last->number);
	return ESKEL_OK;
}

static bool is_same_plane(const esk_plane *a, const esk_plane *b)
{
	for (int i = 0; i < 6; i++)
		if (fabs(a->orientation[i] - b->orientation[i]) > 1e-4)
			return false;
	for (int i = 0; i < 2; i++)
		if (fabs(a->spacing[i] - b->spacing[i]) > 1e-4 * fabs(a->spacing[i]))
			return false;
	return true;
}

static eskel_status check_plane(const esk_segmentation *s, eskel_error *error)
{
	const size_t number = s->frame_count + 1;
	const esk_plane *plane = &s->current;
	const char *missing = !plane->positioned ? "position (ImagePositionPatient)"
			      : !plane->oriented ? "orientation (ImageOrientationPatient)"
			      : !plane->spaced   ? "spacing (PixelSpacing)"
						 : NULL;
	if (missing)
		return esk_refuse(error, ESKEL_BAD_GEOMETRY, "frame %zu has no %s", number, missing);
	for (int i = 0; i < 3; i++)
		if (fabs(plane->position[i]) > farthest)
			return esk_refuse(error, ESKEL_BAD_GEOMETRY,
				"frame %zu is at %g mm, expected a place within %g", number, plane->position[i],
				farthest);
	if (s->frame_count > 0 && !is_same_plane(&s->first, plane))
		return esk_refuse(error, ESKEL_UNSUPPORTED,
			"frame %zu has an orientation or spacing other than frame 1, expected one grid", number);
	return ESKEL_OK;
}

static eskel_status end_frame(esk_segmentation *s, eskel_error *error)
{
	eskel_status status = check_plane(s, error);
	void *items = s->frames;
	if (status != ESKEL_OK)
		return status;
	if (s->frame_count == most_frames)
		return esk_refuse(error, ESKEL_TOO_LARGE, "the segmentation has more than %d frames", most_frames);
	if (!reserve(&items, &s->frame_capacity, s->frame_count, sizeof *s->frames))
		return esk_refuse(error, ESKEL_NO_MEMORY, "memory ran out for %zu frames", s->frame_count + 1);
	s->frames = items;
	if (s->frame_count == 0)
		s->first = s->current;
	esk_frame *frame = &s->frames[s->frame_count++];
	*frame = (esk_frame){.segment = s->current.segment};
	memcpy(frame->position, s->current.position, sizeof frame->position);
	return ESKEL_OK;
}

static eskel_status take_item(void *reader, uint32_t sequence, bool begins, eskel_error *error)
{
	esk_segmentation *s = reader;
	if (sequence == ESK_SEGMENTS)
		return begins ? begin_segment(s, error) : end_segment(s, error);
	if (sequence != ESK_FRAME_GROUPS)
		return ESKEL_OK;
	if (!begins)
		return end_frame(s, error);
	s->current = s->shared;
	return ESKEL_OK;
}

/* ---- the whole */

static bool is_segment(const esk_segmentation *s, uint16_t number)
{
	for (size_t i = 0; i < s->segment_count; i++)
		if (s->segments[i].number == number)
			return true;
	return false;
}

static eskel_status check_frames(esk_segmentation *s, eskel_error *error)
{
	if (s->frame_count == 0 || s->frame_count != s->frames_announced)
		return esk_refuse(error, ESKEL_MALFORMED,
			"the segmentation has %u frames and the places of %zu, expected as many, and one at least",
			s->frames_announced, s->frame_count);
	for (size_t i = 0; i < s->frame_count; i++) {
		if (s->type == ESK_LABEL_MAP)
			s->frames[i].segment = 0;
		else if ((i == 0 || s->frames[i].segment != s->frames[i - 1].segment) &&
			 !is_segment(s, s->frames[i].segment))
			return esk_refuse(error, ESKEL_MALFORMED, "frame %zu is of segment %d, which is not described",
				i + 1, (int)s->frames[i].segment);
	}
	return ESKEL_OK;
}

static eskel_status check_pixels(const esk_segmentation *s, uint32_t pixel_bytes, eskel_error *error)
{
	const bool good_bits =
		s->type == ESK_BINARY ? s->bits == 1 : s->bits == 8 || (s->type == ESK_LABEL_MAP && s->bits == 16);
	if (s->samples != 1 || !good_bits)
		return esk_refuse(error, ESKEL_UNSUPPORTED,
			"the segmentation has pixels of %d x %d bits, expected one of %s", s->samples, s->bits,
			s->type == ESK_BINARY       ? "1 bit"
			: s->type == ESK_FRACTIONAL ? "8 bits"
						    : "8 or 16 bits");
	if (s->rows == 0 || s->columns == 0)
		return esk_refuse(
			error, ESKEL_MALFORMED, "the segmentation has %d rows and %d columns", s->rows, s->columns);
	const uint64_t bits = (uint64_t)s->rows * s->columns * s->bits * s->frame_count, bytes = (bits + 7) / 8;
	if (pixel_bytes != bytes + bytes % 2)
		return esk_refuse(error, ESKEL_MALFORMED,
			"the pixels of %zu frames of %d x %d have %u bytes, expected %llu", s->frame_count, s->columns,
			s->rows, pixel_bytes, (unsigned long long)(bytes + bytes % 2));
	return ESKEL_OK;
}

eskel_status esk_segmentation_read(
	esk_window *window, esk_segmentation *segmentation, uint32_t *pixel_bytes, eskel_error *error)
{
	static const esk_element_visitor visitor = {.wants = wants, .value = take_value, .item = take_item};
	segmentation->samples = 1;
	eskel_status status = esk_elements_read(window, &visitor, segmentation, pixel_bytes, error);
	if (status == ESKEL_OK && !segmentation->is_segmentation)
		status = esk_refuse(
			error, ESKEL_UNSUPPORTED, "the DICOM file does not say its class, expected a segmentation");
	if (status == ESKEL_OK)
		status = check_frames(segmentation, error);
	return status == ESKEL_OK ? check_pixels(segmentation, *pixel_bytes, error) : status;
}

void esk_segmentation_clear(esk_segmentation *segmentation)
{
	free(segmentation->segments);
	free(segmentation->frames);
	*segmentation = (esk_segmentation){0};
}
