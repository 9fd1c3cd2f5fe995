/* What a person should know about an accepted label: how its grid, its voxels and its pieces limit what can be told. */
#include "specimen.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* Below this many voxels the surface outweighs the inside: at 1000 (a cube of 10) half of them lie on the border, and
 * the signature follows the grid more than the object. */
#define FEW_VOXELS 1000

/* The longest edge of a voxel by its shortest. With edges of one to two (.8 x .8 x 1.6 mm) the talus of the tests is at a
 * distance of .036 from itself in cubic voxels and .198 from the other talus of the same person, so that is no reason. */
#define ANISOTROPIC 2.5

/* Between two axes of the grid, degrees off the right angle. Directions rounded to four digits are off by less than .01. */
#define OBLIQUE .5

/* The volume's own and one for each kind that a label may add. */
#define MOST_WARNINGS (ESKEL_VOLUME_WARNINGS_MAX + 8)

static void warn(eskel_shape *shape, eskel_warning_code code, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

static void warn(eskel_shape *shape, eskel_warning_code code, const char *format, ...)
{
	eskel_warning *warning = &shape->warnings[shape->warning_count++];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(warning->text, sizeof warning->text, format, arguments);
	va_end(arguments);
	warning->code = code;
}

static double dot(const eskel_affine *affine, int a, int b)
{
	double sum = 0;
	for (int r = 0; r < 3; r++)
		sum += affine->m[r][a] * affine->m[r][b];
	return sum;
}

static void warn_of_grid(eskel_shape *shape, const eskel_affine *affine)
{
	double spacing[3], shortest = INFINITY, longest = 0, worst = 90;
	for (int a = 0; a < 3; a++) {
		spacing[a] = sqrt(dot(affine, a, a));
		shortest = fmin(shortest, spacing[a]);
		longest = fmax(longest, spacing[a]);
	}
	for (int a = 0; a < 3; a++) {
		const int b = (a + 1) % 3;
		const double cosine = fmin(fabs(dot(affine, a, b)) / (spacing[a] * spacing[b]), 1);
		worst = fmin(worst, acos(cosine) * (180 / M_PI));
	}
	if (longest > ANISOTROPIC * shortest)
		warn(shape, ESKEL_WARNING_ANISOTROPIC,
			"the voxels are %.4g x %.4g x %.4g mm: what is thinner than the longest edge is lost",
			spacing[0], spacing[1], spacing[2]);
	if (worst < 90 - OBLIQUE)
		warn(shape, ESKEL_WARNING_NOT_ORTHOGONAL,
			"two axes of the grid meet at %.1f degrees, not at right angles: this is kept, but is it "
			"meant?",
			worst);
}

static void warn_of_border(eskel_shape *shape, unsigned border)
{
	static const char *const sides[] = {
		"first low", "first high", "second low", "second high", "third low", "third high"};
	char text[100] = "";
	for (unsigned side = 0, used = 0; side < 6; side++)
		if (border >> side & 1)
			used += (unsigned)snprintf(
				text + used, sizeof text - used, "%s%s", used ? ", " : "", sides[side]);
	if (border)
		warn(shape, ESKEL_WARNING_TOUCHES_BORDER,
			"the object touches the border of the grid (%s index): it may be cut off", text);
}

static bool warn_of_pieces(eskel_shape *shape, const eskel_cloud *cloud)
{
	eskel_components *pieces = NULL, *cavities = NULL;
	const bool good = eskel_cloud_components(cloud, &pieces) == ESKEL_OK &&
			  eskel_cloud_cavities(cloud, &cavities) == ESKEL_OK;
	if (good && pieces->count > 1)
		warn(shape, ESKEL_WARNING_FRAGMENTED,
			"the object is in %zu pieces: the largest has %" PRIu64 " of %" PRIu64
			" voxels, the next %" PRIu64,
			pieces->count, pieces->sizes[0], cloud->voxels, pieces->sizes[1]);
	if (good && cavities->count > 0)
		warn(shape, ESKEL_WARNING_HOLES, "the object encloses %zu cavit%s of %" PRIu64 " voxels",
			cavities->count, cavities->count > 1 ? "ies" : "y", cavities->voxels);
	eskel_components_free(pieces);
	eskel_components_free(cavities);
	return good;
}

static void warn_of_size(eskel_shape *shape, const eskel_node *whole, uint32_t levels)
{
	if (shape->voxels < FEW_VOXELS)
		warn(shape, ESKEL_WARNING_FEW_VOXELS,
			"the object has %" PRIu64 " voxels, fewer than %d: the signature follows the grid",
			shape->voxels, FEW_VOXELS);
	/* An oblique plane has eigenvalues of rounding errors in place of 0. */
	if (whole->eigenvalues[2] <= 1e-12 * whole->eigenvalues[0])
		warn(shape, ESKEL_WARNING_FLAT, "the object is flat: its smallest eigenvalue is 0, so it is no solid");
	if (shape->levels < levels)
		warn(shape, ESKEL_WARNING_FEWER_LEVELS, "the object has %" PRIu32 " levels, %" PRIu32 " were asked for",
			shape->levels, levels);
}

bool esk_specimen_warn(esk_specimen *specimen, const esk_specimens *specimens, uint32_t levels)
{
	eskel_shape *shape = &specimen->shape;
	shape->warnings = calloc(MOST_WARNINGS, sizeof *shape->warnings);
	if (!shape->warnings)
		return false;
	for (size_t i = 0; i < specimens->warning_count; i++)
		shape->warnings[shape->warning_count++] = specimens->warnings[i];
	warn_of_grid(shape, &specimen->cloud->affine);
	warn_of_border(shape, specimen->border);
	warn_of_size(shape, eskel_skeleton_node(specimen->skeleton, 1, 0), levels);
	return warn_of_pieces(shape, specimen->cloud);
}
