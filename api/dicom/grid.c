/* Frames are parallel planes. With unit vectors r along a row and c along a column, and n = r x c, the position p of
 * a frame has the height n.p, which gives its slice, and lies beside that of the first frame by r.(p - p_0) and c.(p
 * - p_0), whole numbers of columns and rows.
 *
 * How far slices are apart is measured, not believed: SliceThickness may be anything, SpacingBetweenSlices is often
 * missing or wrong. What is said of it only decides where it divides all distances between the slices that are there:
 * then slices are left out between those, as in files that keep no empty frames. Else the smallest distance does.
 */
#include "grid.h"

#include "refusal.h"

#include <math.h>
#include <stdlib.h>

/* In parts of a pixel or of the distance of slices: positions are rounded by their writers. */
static const double tolerance = 0.05;
/* Heights nearer than this part of a pixel are of the same slice. */
static const double same_slice = 0.01;
static const double most_steps = UINT16_MAX;

typedef struct {
	double height;
	uint32_t frame;
} level;

typedef struct {
	esk_segmentation *segmentation;
	double row[3], column[3], normal[3];
	double pixel;    /* the smaller side, mm */
	level *levels;   /* of each frame, ascending */
	double distance; /* of slices, mm */
} fitting;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static eskel_status find_axes(fitting *f, eskel_error *error)
{
	const esk_plane *plane = &f->segmentation->first;
	const double *r = plane->orientation, *c = plane->orientation + 3;
	const double lengths[2] = {sqrt(dot(r, r)), sqrt(dot(c, c))};
	if (!(fabs(lengths[0] - 1) < 0.01) || !(fabs(lengths[1] - 1) < 0.01) || !(fabs(dot(r, c)) < 0.01))
		return esk_refuse(error, ESKEL_BAD_GEOMETRY,
			"ImageOrientationPatient has vectors of length %g and %g and product %g, expected 1, 1 and 0",
			lengths[0], lengths[1], dot(r, c));
	if (!(plane->spacing[0] > 0) || !(plane->spacing[1] > 0))
		return esk_refuse(error, ESKEL_BAD_GEOMETRY, "PixelSpacing is %g and %g, expected positive numbers",
			plane->spacing[0], plane->spacing[1]);
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;
		f->row[i] = r[i] / lengths[0];
		f->column[i] = c[i] / lengths[1];
		f->normal[i] = (r[j] * c[k] - r[k] * c[j]) / (lengths[0] * lengths[1]);
	}
	f->pixel = fmin(plane->spacing[0], plane->spacing[1]);
	return ESKEL_OK;
}

/* ---- slices */

static int compare_levels(const void *a, const void *b)
{
	const level *p = a, *q = b;
	if (p->height != q->height)
		return p->height < q->height ? -1 : 1;
	return (p->frame > q->frame) - (p->frame < q->frame);
}

static void find_levels(fitting *f)
{
	const esk_segmentation *s = f->segmentation;
	for (size_t i = 0; i < s->frame_count; i++)
		f->levels[i] = (level){dot(f->normal, s->frames[i].position), (uint32_t)i};
	qsort(f->levels, s->frame_count, sizeof *f->levels, compare_levels);
}

static double span_of(const fitting *f)
{
	return f->levels[f->segmentation->frame_count - 1].height - f->levels[0].height;
}

/* The smallest distance of slices; 0 when there is one only. */
static double least_distance(const fitting *f)
{
	double least = 0;
	for (size_t i = 1; i < f->segmentation->frame_count; i++) {
		const double distance = f->levels[i].height - f->levels[i - 1].height;
		if (distance > same_slice * f->pixel && (least == 0 || distance < least))
			least = distance;
	}
	return least;
}

/* Counts slices of about this distance from the lowest frame on, each from the one before, so that what the distance
 * is off by does not add up; *worst is how far a frame is from its slice, in parts of the mean distance. */
static void place_slices(fitting *f, double distance, size_t *worst)
{
	esk_frame *frames = f->segmentation->frames;
	const size_t count = f->segmentation->frame_count;
	double steps = 0;
	for (size_t i = 0; i < count && steps <= most_steps; i++) {
		steps += i > 0 ? round((f->levels[i].height - f->levels[i - 1].height) / distance) : 0;
		frames[f->levels[i].frame].place[2] = (uint16_t)fmin(steps, most_steps);
	}
	f->distance = steps > 0 ? span_of(f) / steps : distance;
	*worst = 0;
	double farthest = 0;
	for (size_t i = 0; i < count; i++) {
		const double expected = f->levels[0].height + f->distance * frames[f->levels[i].frame].place[2];
		const double off = fabs(f->levels[i].height - expected);
		if (off > farthest) {
			farthest = off;
			*worst = i;
		}
	}
}

static bool are_even(const fitting *f, size_t worst)
{
	const double expected =
		f->levels[0].height + f->distance * f->segmentation->frames[f->levels[worst].frame].place[2];
	return fabs(f->levels[worst].height - expected) <= tolerance * f->distance;
}

static eskel_status place_single_slice(fitting *f, eskel_volume_info *info, eskel_error *error)
{
	const esk_plane *plane = &f->segmentation->first;
	f->distance = plane->between > 0 ? plane->between : plane->thickness;
	if (!(f->distance > 0))
		return esk_refuse(error, ESKEL_BAD_GEOMETRY,
			"all frames are in one slice, which has neither SpacingBetweenSlices nor SliceThickness");
	eskel_volume_warn(info, ESKEL_WARNING_SLICE_DISTANCE,
		"all frames are in one slice: its thickness is taken from the file, %.4g mm", f->distance);
	return ESKEL_OK;
}

static eskel_status find_slices(fitting *f, eskel_volume_info *info, eskel_error *error)
{
	const esk_plane *plane = &f->segmentation->first;
	const double least = least_distance(f), said = fabs(plane->between);
	size_t worst = 0;
	if (least == 0)
		return place_single_slice(f, info, error);
	if (said > tolerance * least && said <= (1 + tolerance) * least) {
		place_slices(f, said, &worst);
		if (are_even(f, worst))
			return ESKEL_OK;
	}
	place_slices(f, least, &worst);
	if (!are_even(f, worst))
		return esk_refuse(error, ESKEL_UNSUPPORTED,
			"the slice of frame %u is at %.6g mm, expected slices that are evenly %.4g mm apart",
			f->levels[worst].frame + 1, f->levels[worst].height - f->levels[0].height, f->distance);
	if (said > 0)
		eskel_volume_warn(info, ESKEL_WARNING_SLICE_DISTANCE,
			"SpacingBetweenSlices is %.4g mm, but the slices are %.4g mm apart, which is taken", said,
			f->distance);
	else if (plane->thickness > 0 && f->distance > 1.5 * plane->thickness)
		eskel_volume_warn(info, ESKEL_WARNING_SLICE_DISTANCE,
			"slices are %.4g mm apart and %.4g mm thick: if some are left out, objects are too thick",
			f->distance, plane->thickness);
	return ESKEL_OK;
}

/* ---- places within slices */

/* How many columns (axis 0) or rows (axis 1) a frame lies beside the first. */
static double pixels_beside(const fitting *f, size_t frame, int axis)
{
	const esk_segmentation *s = f->segmentation;
	const double *p = s->frames[frame].position, *first = s->frames[0].position;
	const double beside[3] = {p[0] - first[0], p[1] - first[1], p[2] - first[2]};
	return axis == 0 ? dot(f->row, beside) / s->first.spacing[1] : dot(f->column, beside) / s->first.spacing[0];
}

static eskel_status find_places(const fitting *f, double least[2], double most[2], eskel_error *error)
{
	for (int a = 0; a < 2; a++) {
		least[a] = most[a] = 0;
		for (size_t i = 0; i < f->segmentation->frame_count; i++) {
			const double pixels = pixels_beside(f, i, a), whole = round(pixels);
			if (fabs(pixels - whole) > tolerance)
				return esk_refuse(error, ESKEL_UNSUPPORTED,
					"frame %zu lies %.4g pixels beside frame 1, expected a whole number: slices "
					"that shift, as of a tilted gantry, are to be resampled first",
					i + 1, pixels);
			least[a] = fmin(least[a], whole);
			most[a] = fmax(most[a], whole);
		}
	}
	return ESKEL_OK;
}

static void set_places(const fitting *f, const double least[2])
{
	esk_segmentation *s = f->segmentation;
	for (size_t i = 0; i < s->frame_count; i++)
		for (int a = 0; a < 2; a++)
			s->frames[i].place[a] = (uint16_t)(round(pixels_beside(f, i, a)) - least[a]);
}

static int compare_numbers(const void *a, const void *b)
{
	const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
	return (p > q) - (p < q);
}

/* No frame may lie on another one of its segment. */
static eskel_status check_distinct(const esk_segmentation *s, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	uint64_t *keys = malloc(s->frame_count * sizeof *keys);
	if (!keys)
		return esk_refuse(error, ESKEL_NO_MEMORY, "memory ran out for %zu frames", s->frame_count);
	for (size_t i = 0; i < s->frame_count; i++)
		keys[i] = (uint64_t)s->frames[i].segment << 48 | (uint64_t)s->frames[i].place[2] << 32 | i;
	qsort(keys, s->frame_count, sizeof *keys, compare_numbers);
	for (size_t i = 1; i < s->frame_count && status == ESKEL_OK; i++)
		if (keys[i] >> 32 == keys[i - 1] >> 32)
			status = esk_refuse(error, ESKEL_MALFORMED,
				"frames %u and %u are of the same segment in the same slice, expected one",
				(unsigned)(uint32_t)keys[i - 1] + 1, (unsigned)(uint32_t)keys[i] + 1);
	free(keys);
	return status;
}

/* ---- the whole */

/* LPS to RAS turns the first two coordinates about. Adding 0 makes -0 that. */
static void set_affine(const fitting *f, const double least[2], eskel_affine *affine)
{
	const esk_plane *plane = &f->segmentation->first;
	const double *first = f->segmentation->frames[0].position;
	const double up = f->levels[0].height - dot(f->normal, first);
	for (int i = 0; i < 3; i++) {
		const double sign = i < 2 ? -1 : 1;
		const double column = f->row[i] * plane->spacing[1], row = f->column[i] * plane->spacing[0];
		const double origin = first[i] + least[0] * column + least[1] * row + up * f->normal[i];
		const double vectors[4] = {column, row, f->normal[i] * f->distance, origin};
		for (int c = 0; c < 4; c++)
			affine->m[i][c] = sign * vectors[c] + 0.0;
	}
}

static eskel_status set_extent(
	const fitting *f, const double least[2], const double most[2], eskel_volume_info *info, eskel_error *error)
{
	const esk_segmentation *s = f->segmentation;
	const double extent[3] = {
		most[0] - least[0] + s->columns, most[1] - least[1] + s->rows, round(span_of(f) / f->distance) + 1};
	for (int a = 0; a < 3; a++) {
		if (!(extent[a] <= UINT16_MAX))
			return esk_refuse(error, ESKEL_TOO_LARGE,
				"the frames reach over %.0f x %.0f x %.0f voxels, expected at most 65535 each way",
				extent[0], extent[1], extent[2]);
		info->extent[a] = (uint32_t)extent[a];
	}
	return ESKEL_OK;
}

static eskel_status fit(fitting *f, eskel_volume_info *info, eskel_error *error)
{
	double least[2], most[2];
	eskel_status status = find_axes(f, error);
	if (status != ESKEL_OK)
		return status;
	find_levels(f);
	status = find_slices(f, info, error);
	if (status == ESKEL_OK)
		status = find_places(f, least, most, error);
	if (status == ESKEL_OK)
		status = set_extent(f, least, most, info, error);
	if (status != ESKEL_OK)
		return status;
	set_places(f, least);
	set_affine(f, least, &info->affine);
	return check_distinct(f->segmentation, error);
}

eskel_status esk_grid_fit(esk_segmentation *segmentation, eskel_volume_info *info, eskel_error *error)
{
	eskel_volume_info fitted = {.format = "DICOM"};
	fitting f = {.segmentation = segmentation, .levels = malloc(segmentation->frame_count * sizeof *f.levels)};
	eskel_status status = f.levels ? fit(&f, &fitted, error)
				       : esk_refuse(error, ESKEL_NO_MEMORY, "memory ran out for %zu frames",
						 segmentation->frame_count);
	free(f.levels);
	if (status == ESKEL_OK)
		*info = fitted;
	return status;
}
