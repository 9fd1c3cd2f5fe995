/* The surface of a cloud: the faces between its voxels and others, in two triangles each.
 *
 * Voxels are joined over faces (6-neighbour rule): where two touch along an edge or in a corner only, the surface runs around
 * each of them, and a corner of the grid is more than one vertex. At a corner, twelve faces may meet, between the eight
 * voxels around it; two that share an edge are neighbours there, and of four those two that are of the same voxel are. A
 * vertex is a set of faces that are connected so. Which faces belong together depends on which of the eight voxels are there:
 * a table of 256 cases.
 *
 * Two pairs of faces that touch along an edge may still share the vertices at both of its ends, where voxels above and below
 * join them: then each pair has a vertex of its own in the middle of the edge.
 *
 * Corners are numbered plane by plane, and faces written layer by layer: no more than three layers of voxels are ever unpacked. */
#include "affine.h"
#include "error.h"
#include "memory.h"
#include "mesh.h"

#include <stdlib.h>
#include <string.h>

/* Of the box around a cloud, which is passed through: some seconds. */
static const uint64_t most_places = (uint64_t)1 << 31;

enum { CASES = 256, FACES = 12, EDGES = 12 };

/* Corner tables: octants are the eight voxels around a corner, bit a of an octant's number is 1 on the upper side of axis a. */
typedef struct {
	uint8_t counts[CASES];          /* vertices */
	uint8_t vertices[CASES][FACES]; /* of each face between octants, by face_at */
} corner_table;

typedef struct {
	const eskel_cloud *cloud;
	corner_table table;
	size_t width, height; /* of a layer with a margin of one voxel on every side */
	uint8_t *layers[3];   /* below, at and above z; 1: a voxel */
	uint32_t *corners[2]; /* the first vertex of each corner below and above layer z */
	size_t next_run;
	double (*points)[3]; /* vertices, index coordinates */
	uint32_t (*triangles)[3];
	size_t point_count, point_capacity, triangle_count, triangle_capacity;
	eskel_error *error;
} surface;

/* The face across axis a of an octant, by the two other bits. */
static int face_at(unsigned octant, int axis)
{
	const int low = axis == 0 ? 1 : 0, high = axis == 2 ? 1 : 2;
	return 4 * axis + (int)(octant >> low & 1) + 2 * (int)(octant >> high & 1);
}

static void join(uint8_t sets[FACES], int a, int b)
{
	const uint8_t from = sets[b], to = sets[a];
	for (int f = 0; f < FACES; f++)
		if (sets[f] == from)
			sets[f] = to;
}

/* Joins faces along the edge that leaves the corner on a side of an axis. */
static void join_along(unsigned inside, int axis, unsigned side, uint8_t sets[FACES])
{
	const int u = (axis + 1) % 3, v = (axis + 2) % 3;
	unsigned ring[4]; /* octants around the edge */
	int faces[4], cut[4], count = 0;
	for (unsigned i = 0; i < 4; i++)
		ring[i] = side << axis | ((i == 1 || i == 2) ? 1u << u : 0) | (i >= 2 ? 1u << v : 0);
	for (int i = 0; i < 4; i++) {
		const unsigned next = ring[(i + 1) % 4];
		faces[i] = face_at(ring[i], i % 2 ? v : u);
		cut[i] = (inside >> ring[i] & 1) != (inside >> next & 1);
		count += cut[i];
	}
	/* Around an octant inside, its two faces; where there are two in all, these. */
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < i; j++)
			if (cut[i] && cut[j] &&
				(count == 2 || (i - j == 1 && inside >> ring[i] & 1) ||
					(i - j == 3 && inside >> ring[0] & 1)))
				join(sets, faces[i], faces[j]);
}

static void make_case(unsigned inside, corner_table *table)
{
	uint8_t sets[FACES], numbers[FACES];
	for (uint8_t f = 0; f < FACES; f++)
		sets[f] = f;
	for (int axis = 0; axis < 3; axis++)
		for (unsigned side = 0; side < 2; side++)
			join_along(inside, axis, side, sets);
	memset(numbers, 0xff, sizeof numbers);
	uint8_t count = 0;
	for (unsigned octant = 0; octant < 8; octant++)
		for (int axis = 0; axis < 3; axis++) {
			const unsigned other = octant ^ 1u << axis;
			if (other < octant || (inside >> octant & 1) == (inside >> other & 1))
				continue;
			const int face = face_at(octant, axis);
			if (numbers[sets[face]] == UINT8_MAX)
				numbers[sets[face]] = count++;
			table->vertices[inside][face] = numbers[sets[face]];
		}
	table->counts[inside] = count;
}

static eskel_status no_memory(const surface *s)
{
	return esk_error_set(
		s->error, ESKEL_NO_MEMORY, "memory ran out for a mesh of %zu triangles", s->triangle_count);
}

static void unpack_layer(surface *s, size_t z, uint8_t *layer)
{
	memset(layer, 0, s->width * s->height);
	for (; s->next_run < s->cloud->run_count && s->cloud->runs[s->next_run].z == z; s->next_run++) {
		const eskel_run *r = &s->cloud->runs[s->next_run];
		memset(layer + (r->y + 1u) * s->width + r->x_first + 1, 1, r->x_last - r->x_first + 1u);
	}
}

/* The case of the corner below voxel (x, y) of a layer, counted with the margin. */
static unsigned case_of(const surface *s, const uint8_t *below, const uint8_t *above, size_t x, size_t y)
{
	unsigned inside = 0;
	for (unsigned octant = 0; octant < 8; octant++) {
		const uint8_t *layer = octant & 4 ? above : below;
		inside |= (unsigned)layer[(y - 1 + (octant >> 1 & 1)) * s->width + x - 1 + (octant & 1)] << octant;
	}
	return inside;
}

static bool add_point(surface *s, const double point[3], uint32_t *number)
{
	void *points = s->points;
	if (s->point_count == UINT32_MAX - 1 ||
		!esk_memory_reserve(&points, &s->point_capacity, s->point_count + 1, sizeof *s->points))
		return false;
	s->points = points;
	memcpy(s->points[s->point_count], point, sizeof *s->points);
	*number = (uint32_t)s->point_count++;
	return true;
}

/* The vertices between two layers, of which the upper is z. */
static bool add_corners(surface *s, size_t z, const uint8_t *below, const uint8_t *above, uint32_t *corners)
{
	for (size_t y = 1; y < s->height; y++)
		for (size_t x = 1; x < s->width; x++) {
			const double point[3] = {(double)x - 1.5, (double)y - 1.5, (double)z - 0.5};
			corners[y * s->width + x] = (uint32_t)s->point_count;
			for (int n = s->table.counts[case_of(s, below, above, x, y)]; n > 0; n--) {
				uint32_t number;
				if (!add_point(s, point, &number))
					return false;
			}
		}
	return true;
}

/* What surrounds a voxel. */
typedef struct {
	unsigned cases[8]; /* of its corners */
	uint32_t firsts[8];
	uint32_t middles[EDGES]; /* UINT32_MAX: none made */
} voxel;

static bool has_neighbour(const voxel *v, int axis, unsigned side)
{
	/* At the corner on that side, the voxel is the octant opposite to the corner's place. */
	const unsigned corner = side << axis, octant = 7 ^ corner;
	return v->cases[corner] >> (octant ^ 1u << axis) & 1;
}

/* The vertex of the voxel's face across an axis at a corner. */
static uint32_t vertex_at(const surface *s, const voxel *v, unsigned corner, int axis)
{
	return v->firsts[corner] + s->table.vertices[v->cases[corner]][face_at(7 ^ corner, axis)];
}

/* Whether, along an edge of the voxel, another pair of faces has the same vertices at both ends. */
static bool is_doubled(const surface *s, const voxel *v, unsigned corner, int along)
{
	const int u = (along + 1) % 3, w = (along + 2) % 3;
	for (unsigned end = 0; end < 2; end++) {
		const unsigned c = (corner & ~(1u << along)) | end << along, own = 7 ^ c;
		const unsigned inside = v->cases[c], other = own ^ 1u << u ^ 1u << w;
		if (!(inside >> other & 1) || inside >> (own ^ 1u << u) & 1 || inside >> (own ^ 1u << w) & 1)
			return false;
		const uint8_t *vertices = s->table.vertices[inside];
		if (vertices[face_at(own, u)] != vertices[face_at(other, u)])
			return false;
	}
	return true;
}

/* The vertex in the middle of an edge, which both faces of the voxel there share. */
static bool middle_of(surface *s, voxel *v, unsigned corner, int along, uint32_t *vertex)
{
	uint32_t *known = &v->middles[face_at(corner, along)];
	if (*known == UINT32_MAX) {
		const uint32_t first = v->firsts[corner & ~(1u << along)];
		double point[3];
		memcpy(point, s->points[first], sizeof point);
		point[along] += 0.5;
		if (!add_point(s, point, known))
			return false;
	}
	*vertex = *known;
	return true;
}

static bool add_triangle(surface *s, uint32_t a, uint32_t b, uint32_t c)
{
	void *triangles = s->triangles;
	if (!esk_memory_reserve(&triangles, &s->triangle_capacity, s->triangle_count + 1, sizeof *s->triangles))
		return false;
	s->triangles = triangles;
	const uint32_t triangle[3] = {a, b, c};
	memcpy(s->triangles[s->triangle_count++], triangle, sizeof triangle);
	return true;
}

/* As a fan, from a vertex in the middle of an edge if there is one, so that no triangle is flat. */
static bool add_face(surface *s, voxel *v, int axis, unsigned side)
{
	const int u = (axis + 1) % 3, w = (axis + 2) % 3;
	uint32_t outline[8];
	int count = 0, start = 0;
	for (int i = 0; i < 4; i++) {
		/* Counterclockwise from the upper side of the axis, clockwise from the lower. */
		const int turn = side ? i : 3 - i, along = turn % 2 == (int)!side ? u : w;
		const unsigned corner =
			side << axis | ((turn == 1 || turn == 2) ? 1u << u : 0) | (turn >= 2 ? 1u << w : 0);
		outline[count++] = vertex_at(s, v, corner, axis);
		if (is_doubled(s, v, corner, along)) {
			start = count;
			if (!middle_of(s, v, corner, along, &outline[count++]))
				return false;
		}
	}
	for (int i = 1; i + 1 < count; i++)
		if (!add_triangle(s, outline[start], outline[(start + i) % count], outline[(start + i + 1) % count]))
			return false;
	return true;
}

static bool add_voxel(surface *s, size_t x, size_t y)
{
	voxel v;
	memset(v.middles, 0xff, sizeof v.middles);
	for (unsigned c = 0; c < 8; c++) {
		const size_t cx = x + (c & 1), cy = y + (c >> 1 & 1);
		v.cases[c] = case_of(s, s->layers[c >> 2], s->layers[(c >> 2) + 1], cx, cy);
		v.firsts[c] = s->corners[c >> 2][cy * s->width + cx];
	}
	for (int axis = 0; axis < 3; axis++)
		for (unsigned side = 0; side < 2; side++)
			if (!has_neighbour(&v, axis, side) && !add_face(s, &v, axis, side))
				return false;
	return true;
}

static bool is_inner(const surface *s, size_t x, size_t y)
{
	const uint8_t *layer = s->layers[1] + y * s->width + x;
	return layer[-1] && layer[1] && layer[-(ptrdiff_t)s->width] && layer[s->width] &&
	       s->layers[0][y * s->width + x] && s->layers[2][y * s->width + x];
}

static bool add_layer(surface *s)
{
	for (size_t y = 1; y + 1 < s->height; y++)
		for (size_t x = 1; x + 1 < s->width; x++)
			if (s->layers[1][y * s->width + x] && !is_inner(s, x, y) && !add_voxel(s, x, y))
				return false;
	return true;
}

static void rotate_layers(surface *s)
{
	uint8_t *lowest = s->layers[0];
	uint32_t *lower = s->corners[0];
	s->layers[0] = s->layers[1];
	s->layers[1] = s->layers[2];
	s->layers[2] = lowest;
	s->corners[0] = s->corners[1];
	s->corners[1] = lower;
}

static eskel_status add_faces(surface *s)
{
	unpack_layer(s, 0, s->layers[2]);
	bool enough = add_corners(s, 0, s->layers[1], s->layers[2], s->corners[1]);
	for (size_t z = 0; z < s->cloud->extent[2] && enough; z++) {
		rotate_layers(s);
		unpack_layer(s, z + 1, s->layers[2]);
		enough = add_corners(s, z + 1, s->layers[1], s->layers[2], s->corners[1]) && add_layer(s);
	}
	return enough ? ESKEL_OK : no_memory(s);
}

static eskel_status make_mesh(const surface *s, eskel_mesh **mesh)
{
	eskel_mesh *made = esk_mesh_new(s->point_count, s->triangle_count);
	if (!made)
		return no_memory(s);
	for (size_t v = 0; v < s->point_count; v++) {
		double world[3];
		esk_affine_apply(&s->cloud->affine, s->points[v], world);
		for (int a = 0; a < 3; a++)
			made->vertices[v][a] = (float)world[a];
	}
	/* A left-handed affine turns triangles around. */
	const bool turned = eskel_affine_determinant(&s->cloud->affine) < 0;
	for (size_t t = 0; t < s->triangle_count; t++)
		for (int c = 0; c < 3; c++)
			made->triangles[t][c] = s->triangles[t][turned ? 2 - c : c];
	if (esk_mesh_complete_normals(made) != ESKEL_OK) {
		eskel_mesh_free(made);
		return no_memory(s);
	}
	*mesh = made;
	return ESKEL_OK;
}

static eskel_status allocate(surface *s)
{
	bool enough = true;
	for (int l = 0; l < 3; l++)
		enough &= (s->layers[l] = esk_memory_zeroed_array(s->width * s->height, 1)) != NULL;
	for (int c = 0; c < 2; c++)
		enough &= (s->corners[c] = esk_memory_array(s->width * s->height, sizeof *s->corners[c])) != NULL;
	return enough ? ESKEL_OK : no_memory(s);
}

eskel_status eskel_cloud_mesh(const eskel_cloud *cloud, eskel_mesh **mesh, eskel_error *error)
{
	surface s = {.cloud = cloud, .width = cloud->extent[0] + 2u, .height = cloud->extent[1] + 2u, .error = error};
	if ((uint64_t)s.width * s.height * cloud->extent[2] > most_places)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the box of the voxels has %zu x %zu x %u places, expected at most %llu", s.width, s.height,
			cloud->extent[2], (unsigned long long)most_places);
	for (unsigned inside = 0; inside < CASES; inside++)
		make_case(inside, &s.table);
	eskel_status status = allocate(&s);
	if (status == ESKEL_OK)
		status = add_faces(&s);
	if (status == ESKEL_OK)
		status = make_mesh(&s, mesh);
	for (int l = 0; l < 3; l++)
		free(s.layers[l]);
	for (int c = 0; c < 2; c++)
		free(s.corners[c]);
	free(s.points);
	free(s.triangles);
	return status;
}
