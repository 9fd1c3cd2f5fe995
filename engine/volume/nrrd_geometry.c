/* Where the voxels of an NRRD file lie.
 *
 * The anatomical spaces have a known hand, and are turned to RAS. In scanner-xyz, in the nameless 3D-right-handed
 * and in a space that has a dimension only, the patient's position is not known: they are taken as RAS, with a warning;
 * 3D-left-handed is taken as LAS, so that objects keep their hand. Spaces with time are refused. Without space directions
 * the axes are taken as RAS, with the same warning. The space origin is the centre of the first voxel; an axis min is that
 * too for node-centred samples, and the border of the first voxel otherwise, as in teem.
 */
#include "nrrd_geometry.h"

#include "error.h"
#include "volume_format.h"

#include <math.h>
#include <string.h>
#include <strings.h>

typedef struct {
	const esk_nrrd_axes *axes;
	eskel_volume_info *info; /* to be filled */
} reading;

static const char *value_of(const reading *r, esk_nrrd_field field)
{
	return r->axes->fields->values[field];
}

static bool is_there(const reading *r, esk_nrrd_field field)
{
	return value_of(r, field)[0] != 0;
}

/* How a space turns to RAS. Without a name there is a space dimension only. */
static const struct {
	const char *name;
	int sign[3];
	bool anatomical;
} spaces[] = {
	{"right-anterior-superior", {1, 1, 1}, true},
	{"RAS", {1, 1, 1}, true},
	{"left-anterior-superior", {-1, 1, 1}, true},
	{"LAS", {-1, 1, 1}, true},
	{"left-posterior-superior", {-1, -1, 1}, true},
	{"LPS", {-1, -1, 1}, true},
	{"scanner-xyz", {1, 1, 1}, false},
	{"3D-right-handed", {1, 1, 1}, false},
	{"3D-left-handed", {-1, 1, 1}, false},
	{"", {1, 1, 1}, false},
};

static eskel_status find_space(const reading *r, size_t *found, eskel_error *error)
{
	const char *space = value_of(r, ESK_NRRD_SPACE), *dimension = value_of(r, ESK_NRRD_SPACE_DIMENSION);
	if (!space[0] && !dimension[0])
		return esk_error_set(
			error, ESKEL_MALFORMED, "the NRRD header has space directions, expected a space beside them");
	if (dimension[0] && strcmp(dimension, "3") != 0)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the NRRD header's space dimension is \"%.60s\", expected 3", dimension);
	for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++)
		if (strcasecmp(spaces[i].name, space) == 0) {
			*found = i;
			return ESKEL_OK;
		}
	return esk_error_set(error, ESKEL_UNSUPPORTED,
		"the NRRD header's space is \"%.60s\", expected right-anterior-superior, left-anterior-superior, "
		"left-posterior-superior or another without time",
		space);
}

static eskel_status read_directions(const reading *r, eskel_error *error)
{
	size_t space = 0;
	eskel_status status = find_space(r, &space, error);
	if (status != ESKEL_OK)
		return status;
	double vectors[ESK_NRRD_AXES_MOST][3] = {{0}}, origin[3] = {0, 0, 0};
	bool none = false;
	const char *directions = value_of(r, ESK_NRRD_SPACE_DIRECTIONS), *at = value_of(r, ESK_NRRD_SPACE_ORIGIN);
	for (int a = 0; a < r->axes->count; a++)
		esk_nrrd_read_vector(&directions, vectors[a], &none); /* read by find_axes before */
	if (at[0] && (!esk_nrrd_read_vector(&at, origin, &none) || none || *at))
		return esk_nrrd_refuse_list(r->axes, ESK_NRRD_SPACE_ORIGIN, "space origin", "vector (x,y,z)", 1, error);
	for (int row = 0; row < 3; row++) {
		double *m = r->info->affine.m[row];
		for (int c = 0; c < 3; c++)
			m[c] = spaces[space].sign[row] * vectors[r->axes->in_space[c]][row];
		m[3] = spaces[space].sign[row] * origin[row];
	}
	if (!spaces[space].anatomical)
		eskel_volume_warn(r->info, ESKEL_WARNING_NO_ORIENTATION,
			"the space \"%s\" does not say where left is: it is taken as %s, so left and right may be "
			"exchanged",
			spaces[space].name,
			spaces[space].sign[0] > 0 ? "right, front and head" : "left, front and head");
	return ESKEL_OK;
}

static eskel_status read_axis_mins(const reading *r, const double spacings[ESK_NRRD_AXES_MOST], eskel_error *error)
{
	double mins[ESK_NRRD_AXES_MOST];
	eskel_status status = esk_nrrd_read_numbers(r->axes, ESK_NRRD_AXIS_MINS, "axis mins", mins, error);
	if (status != ESKEL_OK)
		return status;
	const char *at = value_of(r, ESK_NRRD_CENTERINGS);
	bool node[ESK_NRRD_AXES_MOST] = {false};
	esk_nrrd_span word;
	for (int a = 0; a < r->axes->count && esk_nrrd_read_word(&at, &word); a++)
		node[a] = esk_nrrd_span_is(word, "node");
	for (int c = 0; c < 3; c++) {
		const int a = r->axes->in_space[c];
		if (isfinite(mins[a])) /* nan: not known */
			r->info->affine.m[c][3] = node[a] ? mins[a] : mins[a] + spacings[a] / 2;
	}
	return ESKEL_OK;
}

static eskel_status read_spacings(const reading *r, eskel_error *error)
{
	double spacings[ESK_NRRD_AXES_MOST];
	if (!is_there(r, ESK_NRRD_SPACINGS))
		return esk_error_set(error, ESKEL_BAD_GEOMETRY,
			"the NRRD header has neither space directions nor spacings, expected the size of a voxel");
	eskel_status status = esk_nrrd_read_numbers(r->axes, ESK_NRRD_SPACINGS, "spacings", spacings, error);
	for (int c = 0; c < 3 && status == ESKEL_OK; c++) {
		const int a = r->axes->in_space[c];
		if (!(spacings[a] > 0)) /* nan included */
			status = esk_error_set(error, ESKEL_BAD_GEOMETRY,
				"the NRRD header's spacing of axis %d is %g, expected a positive one", a, spacings[a]);
		r->info->affine.m[c][c] = spacings[a];
	}
	if (status == ESKEL_OK && is_there(r, ESK_NRRD_AXIS_MINS))
		status = read_axis_mins(r, spacings, error);
	if (status == ESKEL_OK)
		eskel_volume_warn(r->info, ESKEL_WARNING_NO_ORIENTATION,
			"the file has no space directions: its axes are taken as right, front and head, so left and "
			"right may be exchanged");
	return status;
}

static const struct {
	const char *name;
	double mm;
} units[] = {
	{"mm", 1},
	{"millimeter", 1},
	{"millimeters", 1},
	{"millimetre", 1},
	{"um", 1e-3},
	{"micron", 1e-3},
	{"microns", 1e-3},
	{"micrometer", 1e-3},
	{"cm", 10},
	{"centimeter", 10},
	{"m", 1e3},
	{"meter", 1e3},
};

/* 0 for a unit that is not known. */
static double unit_in_mm(esk_nrrd_span unit)
{
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (esk_nrrd_span_is(unit, units[i].name))
			return units[i].mm;
	return 0;
}

/* Space units are one for each coordinate, units one for each axis; those that count must be equal. In an anatomical space
 * millimetres go without saying. */
static eskel_status convert_units(const reading *r, eskel_error *error)
{
	const bool directions = is_there(r, ESK_NRRD_SPACE_DIRECTIONS);
	const esk_nrrd_field field = directions ? ESK_NRRD_SPACE_UNITS : ESK_NRRD_UNITS;
	eskel_volume_info *info = r->info;
	double factors[ESK_NRRD_AXES_MOST] = {0};
	const char *at = value_of(r, field);
	esk_nrrd_span unit;
	for (int i = 0; i < ESK_NRRD_AXES_MOST && esk_nrrd_read_word(&at, &unit); i++)
		factors[i] = unit_in_mm(unit);
	const int first = directions ? 0 : r->axes->in_space[0];
	for (int c = 1; c < 3; c++)
		if (factors[directions ? c : r->axes->in_space[c]] != factors[first])
			return esk_error_set(error, ESKEL_UNSUPPORTED,
				"the NRRD header's units are %.60s, expected the same for each axis",
				value_of(r, field));
	if (factors[first] == 0) {
		if (is_there(r, field) || info->warning_count > 0)
			eskel_volume_warn(info, ESKEL_WARNING_UNIT_ASSUMED,
				"the unit of length is not known (%.60s); mm is assumed",
				is_there(r, field) ? value_of(r, field) : "none is recorded");
		return ESKEL_OK;
	}
	for (int row = 0; row < 3; row++)
		for (int c = 0; c < 4; c++)
			info->affine.m[row][c] *= factors[first];
	return ESKEL_OK;
}

eskel_status esk_nrrd_read_geometry(const esk_nrrd_axes *axes, eskel_volume_info *info, eskel_error *error)
{
	const reading r = {axes, info};
	eskel_status status =
		is_there(&r, ESK_NRRD_SPACE_DIRECTIONS) ? read_directions(&r, error) : read_spacings(&r, error);
	if (status == ESKEL_OK)
		status = convert_units(&r, error);
	return status == ESKEL_OK ? eskel_affine_check(&info->affine, error) : status;
}
