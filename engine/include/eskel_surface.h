/* Surfaces of skeletons, their meshes, and fits to voxels (sections 3 and 4). Part of eskel.h. */
#ifndef ESKEL_SURFACE_H
#define ESKEL_SURFACE_H

#include "eskel_skeleton.h"

/* ---------------------------------------------------------------------------------------------- surface */

/* A surface (section 3) is the zero set of a potential d, without unit, negative inside. Each class of a level has a
 * primitive with a potential d_i of its own, and these are composed:
 *   blend  d = -ln sum_i exp(-alpha_i d_i)   Blinn's; smooth
 *   union  d = min_i d_i
 *
 * A primitive is a superquadric in a frame of its own, deformed. From a point p to its potential, with z along the class's
 * longest axis and everything in units of the radius c along it:
 *   1. moved    q = axes (p - centre) / c
 *   2. bent     x -= bx(q_z), y -= by(q_z); then (x, y) turned by -twist(q_z)
 *   3. scaled   x *= c/a e^(-tx(q_z)), y *= c/b e^(-ty(q_z))
 *   4. warped   y *= e^(-skew x), z -= cup(x, y), z *= e^(-wedge(x, y)), with x and y as they were before this step
 *   5. measured d = N(N(x^2, y^2; e1), z^2; e2) - 1, N(u, v; e) = (u^(1/e) + v^(1/e))^e
 * Steps 2 to 4 change some coordinates by amounts that depend on the others alone, so each is undone exactly whatever its
 * parameters. These are Barr's taper, twist and bend, and polynomials of higher degree in their place; the 21 modes with
 * 3 of translation, 3 of rotation and 3 radii are the 30 parameters of section 3.5. Coordinates that modes depend on
 * count as +-1.25 beyond +-1.25.
 *
 * Where the paper slips, and where we differ:
 * - The ellipsoid of section 3.3 is d = (p - G) Q (p - G)^T - 1 with Q = M^-1 / gamma^2: the printed D has lambda^(-1/2) for
 *   1 / lambda, and the world form lacks the -1. gamma = 2 is right for a blend and sqrt 5 for a union or a single class.
 * - The superquadric of section 3.4 needs |x|, |y|, |z|. Its (e1, e2) are Barr's (e2, e1): here as in the paper, e1
 *   shapes the section across z and e2 the profile along it; 1 is round, near 0 a box, 2 a pyramid.
 * - Its S grows with the power 2 / e2 of the distance from the centre, ours with its square: d = (S + 1)^e2 - 1. The
 *   surface and the sign are the same, an ellipsoid's d as well, and alpha means the same for any exponents. Creases are
 *   rounded, x^2 is x^2 + 2^-24 where e1 or e2 is not 1, so that all derivatives are finite.
 * - d is no length. The distance |d| / |grad d| of section 3.7 is in mm and of the first order.
 * - An even degree does not bound an algebraic surface (section 3.8): eskel_surface_set_algebraic.
 *
 * Lambda below h^2 / 12, the variance of one voxel of side h = (volume / voxels)^(1/3), counts as that: planes, lines and
 * single voxels get the thickness of a voxel. */
typedef enum {
	ESKEL_PRIMITIVE_ELLIPSOID,
	ESKEL_PRIMITIVE_SUPERQUADRIC,   /* with exponents */
	ESKEL_PRIMITIVE_DEFORMED,       /* with exponents and modes */
	ESKEL_PRIMITIVE_ALGEBRAIC
} eskel_primitive_kind;

typedef enum { ESKEL_COMPOSE_BLEND, ESKEL_COMPOSE_UNION } eskel_compose;

/* Z is q_z; x and y are those of step 4. */
typedef enum {
	ESKEL_MODE_TAPER_X, ESKEL_MODE_TAPER_Y,         /* tx, ty: Z */
	ESKEL_MODE_BEND_X, ESKEL_MODE_BEND_Y,           /* bx, by: Z^2 */
	ESKEL_MODE_TWIST,                               /* Z, in radians */
	ESKEL_MODE_BULGE_X, ESKEL_MODE_BULGE_Y,         /* tx, ty: Z^2 */
	ESKEL_MODE_TAPER3_X, ESKEL_MODE_TAPER3_Y,       /* tx, ty: Z^3 */
	ESKEL_MODE_BEND3_X, ESKEL_MODE_BEND3_Y,         /* bx, by: Z^3 */
	ESKEL_MODE_BEND4_X, ESKEL_MODE_BEND4_Y,         /* bx, by: Z^4 */
	ESKEL_MODE_TWIST2, ESKEL_MODE_TWIST3,           /* Z^2, Z^3 */
	ESKEL_MODE_CUP_XX, ESKEL_MODE_CUP_XY, ESKEL_MODE_CUP_YY, /* cup: x^2, x y, y^2 */
	ESKEL_MODE_WEDGE_X, ESKEL_MODE_WEDGE_Y,         /* wedge: x, y */
	ESKEL_MODE_SKEW,                                /* skew: x */
	ESKEL_MODE_COUNT
} eskel_mode;

/* Ranges in which everything stays finite, for points within 1e7 mm of the centre. */
#define ESKEL_MODE_MAX 2.0          /* of |mode| */
#define ESKEL_EXPONENT_MIN 0.1
#define ESKEL_EXPONENT_MAX 1.9
#define ESKEL_RADIUS_MIN 1e-3       /* mm */
#define ESKEL_RADIUS_MAX 1e6
#define ESKEL_ALPHA_MIN 1e-3
#define ESKEL_ALPHA_MAX 1e3

typedef struct {
	eskel_primitive_kind kind;
	double centre[3];                   /* mm */
	double axes[3][3];                  /* rows: the unit x, y, z of the frame; right-handed */
	double radii[3];                    /* mm: a, b, c */
	double exponents[2];                /* e1, e2 */
	double modes[ESKEL_MODE_COUNT];
	double alpha;
} eskel_primitive;

typedef struct {
	eskel_primitive_kind primitive;     /* what a fit may change; all start as ellipsoids. ALGEBRAIC: see below */
	eskel_compose compose;
	double gamma;                       /* radii in standard deviations; default 2, of a union or a single class sqrt 5 */
	double alpha;                       /* of all classes; default 1 */
} eskel_surface_options;

typedef struct eskel_surface eskel_surface;

/* The surface of a level before any fit: the best ellipsoid of each class. ESKEL_INVALID unless the skeleton has the level,
 * gamma is 0.1 to 10, and alpha and the radii that come out are in range. */
ESKEL_API eskel_status eskel_surface_new(const eskel_skeleton *skeleton, uint32_t level,
	const eskel_surface_options *options, eskel_surface **surface);
/* From primitives, none algebraic. ESKEL_INVALID when a number is out of its range or count is not 1 to ESKEL_LEVELS_MAX. */
ESKEL_API eskel_status eskel_surface_compose(const eskel_primitive *primitives, uint32_t count, eskel_compose compose,
	eskel_surface **surface);
ESKEL_API void eskel_surface_free(eskel_surface *surface);

ESKEL_API uint32_t eskel_surface_count(const eskel_surface *surface);
ESKEL_API eskel_compose eskel_surface_composition(const eskel_surface *surface);
/* Of class class_index < count; NULL otherwise. */
ESKEL_API const eskel_primitive *eskel_surface_primitive(const eskel_surface *surface, uint32_t class_index);

/* Replaces the primitive of a class by an algebraic surface of degree 2, 4 or 6 (section 3.8) through boundary points of the
 * class, by least squares, in the class's frame; alpha stays. It is bounded: where the points alone do not make it so, it is
 * drawn to the ellipsoid as much as needed, and proven to lie within three radii along each axis (algebraic.h).
 * ESKEL_INVALID for another degree, a class that there is not, no point, or a point that is not finite; ESKEL_NUMERIC for
 * points too far off to be fitted. */
ESKEL_API eskel_status eskel_surface_set_algebraic(eskel_surface *surface, uint32_t class_index, unsigned degree,
	const double (*points)[3], size_t count);

/* The polynomial of an algebraic class: its coefficients, the surface's own, by powers of x descending, then of y, then of z,
 * where x, y and z are along the class's axes in units of its radii. NULL for other classes. */
ESKEL_API const double *eskel_surface_polynomial(const eskel_surface *surface, uint32_t class_index, unsigned *degree);

/* The potential at a point. */
ESKEL_API double eskel_surface_value(const eskel_surface *surface, const double point[3]);
ESKEL_API void eskel_surface_values(const eskel_surface *surface, size_t count, const double (*points)[3], double *values);
/* The potential, and its gradient in 1/mm. A union's is that of the class that comes first among the least. */
ESKEL_API double eskel_surface_gradient(const eskel_surface *surface, const double point[3], double gradient[3]);
/* d / |grad d| in mm, negative inside, and the unit normal, outwards (0 where there is none). Good to a few percent within a
 * tenth of a radius of the surface. Never more, either way, than the larger of the greatest radius and the distance to the
 * nearest centre. normal may be NULL. */
ESKEL_API double eskel_surface_distance(const eskel_surface *surface, const double point[3], double normal[3]);
/* Exact: d < 0. */
ESKEL_API bool eskel_surface_contains(const eskel_surface *surface, const double point[3]);

ESKEL_API eskel_status eskel_surface_encode(const eskel_surface *surface, uint8_t **bytes, size_t *size);
ESKEL_API eskel_status eskel_surface_decode(const uint8_t *bytes, size_t size, eskel_surface **surface,
	eskel_error *error);

/* ---------------------------------------------------------------------------------------------- mesh */

/* Triangles with vertices in world space, mm; counterclockwise as seen from outside. Normals have length 1 and point
 * outwards. */
typedef struct {
	size_t vertex_count, triangle_count;
	float (*vertices)[3];
	float (*normals)[3];        /* of the surface at the vertices */
	uint32_t (*triangles)[3];   /* vertices */
} eskel_mesh;

ESKEL_API void eskel_mesh_free(eskel_mesh *mesh);

/* mm^2. */
ESKEL_API double eskel_mesh_area(const eskel_mesh *mesh);
/* mm^3, of a closed mesh; negative if its triangles are clockwise from outside. */
ESKEL_API double eskel_mesh_volume(const eskel_mesh *mesh);

typedef struct {
	size_t boundary_edges;      /* of one triangle; 0: the mesh is closed */
	size_t crowded_edges;       /* of more than two */
	size_t crowded_vertices;    /* whose triangles do not follow one another around it */
	size_t turned_edges;        /* along which two triangles run the same way; 0: the mesh is oriented */
	size_t components;          /* joined over vertices */
	int64_t euler;              /* vertices of triangles - edges + triangles: 2 for each sphere, 0 for a torus */
	double least_angle;         /* degrees, of a triangle's corner */
	bool is_manifold;           /* closed, oriented and without crowded edges or vertices */
} eskel_mesh_check_result;

/* ESKEL_INVALID if a triangle has a vertex twice, or one that is not there. O(n log n). */
ESKEL_API eskel_status eskel_mesh_check(const eskel_mesh *mesh, eskel_mesh_check_result *result);

/* The surface with a node of the lattice for each step^3 (mm): a closed manifold with the surface's normals, of at most
 * triangles_max (0: 2^24) triangles. A union of ellipsoids is made of triangles with edges of about a step on each of them,
 * cut where they meet: creases are sharp, and every piece is there, however small. Where ellipsoids touch without crossing,
 * or creases are too close to one another, it is made as the others are. ESKEL_INVALID for a step that is not positive, ESKEL_TOO_LARGE for more triangles, and
 * where modes or an algebraic class lead far beyond the radii, ESKEL_EMPTY where the step is so large that no surface is
 * met. */
ESKEL_API eskel_status eskel_surface_mesh(const eskel_surface *surface, double step, size_t triangles_max,
	eskel_mesh **mesh, eskel_error *error);

/* The surface of the voxels, for comparison: their faces, in two triangles each, without regard to weights. Voxels that touch
 * in an edge or a corner alone are apart, so that it is a closed manifold. ESKEL_TOO_LARGE for a box of more than 2^31 voxels. */
ESKEL_API eskel_status eskel_cloud_mesh(const eskel_cloud *cloud, eskel_mesh **mesh, eskel_error *error);

typedef struct {
	double error;           /* mm: how far the surface may move, by quadrics; 0: as far as it takes */
	size_t triangles;       /* to be reached, as far as the error allows; 0: as few as it allows */
} eskel_simplify_options;

/* A coarser mesh, by meshoptimizer: some of the vertices, with their normals. A closed manifold stays one: where the library
 * leaves none, less is simplified. error, in mm, is what the library says of the result. */
ESKEL_API eskel_status eskel_mesh_simplify(
	const eskel_mesh *mesh, const eskel_simplify_options *options, eskel_mesh **simplified, double *error);

/* Orders triangles and vertices as graphics processors read them fastest, by meshoptimizer. Nothing else changes. */
ESKEL_API eskel_status eskel_mesh_reorder(eskel_mesh *mesh);

typedef enum {
	ESKEL_MESH_STL, /* binary; the frame in its header */
	ESKEL_MESH_PLY, /* binary little endian, with normals; the frame in a comment */
	ESKEL_MESH_OBJ, /* with normals; the frame in a comment */
	ESKEL_MESH_GLB, /* glTF 2.0: metres, Y up and Z to the front by the transform of its node; the frame in its extras */
	ESKEL_MESH_FORMAT_COUNT
} eskel_mesh_format;

/* The axes that vertices are written in: those of the engine, or x to the left and y to the back, as DICOM and ITK have
 * them. STL, PLY and OBJ say SPACE=RAS or SPACE=LPS as 3D Slicer reads it; their unit is mm. */
typedef enum { ESKEL_FRAME_RAS, ESKEL_FRAME_LPS } eskel_frame;

/* Takes the next bytes of a file; false stops writing. */
typedef bool (*eskel_mesh_sink)(void *context, const uint8_t *bytes, size_t size);

/* Writes a file piece by piece, without holding it. The same mesh always gives the same bytes. ESKEL_CANCELLED if the sink
 * stopped; ESKEL_TOO_LARGE for a GLB of 4 GB; ESKEL_EMPTY for a GLB without triangles, which glTF does not allow. */
ESKEL_API eskel_status eskel_mesh_write(const eskel_mesh *mesh, eskel_mesh_format format, eskel_frame frame,
	eskel_mesh_sink sink, void *context);

/* ---------------------------------------------------------------------------------------------- reconstruction */

/* How far a surface and a cloud are apart, mm. The cloud's surface is its voxel faces (6 neighbours); points on it are their
 * centres, each for its area. These are up to half a voxel off the surface that was sampled: 0.17 voxel in the mean over
 * directions, below which no mean can go. */
typedef struct {
	double mean_delta, greatest_delta;  /* |d| / |grad d| from the boundary (section 3.7): first-order, too small or too
	                                     * large where |grad d| changes; saturating at the cube root of the volume */
	double mean_error, greatest_error;  /* e_me and e_max: the exact distance from the boundary to the surface */
	double mean_distance;               /* symmetric: half of e_me and of the mean distance from surface to boundary */
	double hausdorff_95;                /* of both ways, the larger 95th percentile */
	double dice;                        /* of voxel centres in the cloud and in the surface */
	double volume_ratio;                /* voxel centres in the surface over those in the cloud */
} eskel_surface_error;

/* ESKEL_EMPTY if there is no surface, ESKEL_TOO_LARGE for more than 2^26 voxel faces or if it is thrice as wide as the cloud
 * and more. About 0.1 s for 100,000 voxels. */
ESKEL_API eskel_status eskel_surface_errors(const eskel_surface *surface, const eskel_cloud *cloud, uint32_t threads,
	eskel_surface_error *errors, eskel_error *error);

/* How a surface is fitted to a cloud (sections 3.6 and 3.8); all but the last fit a blend:
 *   joint    all parameters of all classes at once, by Levenberg and Marquardt from the best ellipsoids
 *   tabu     the paper's: each primitive to the boundary of its class, by tabu search, then descent; then the alphas.
 *            Parts of a class's boundary that other classes cover are not the surface's, so where it helps is narrow
 *   hopping  joint, then again from perturbed parameters; what is better is kept. Never worse than joint
 *   squares  least squares: the union of an algebraic surface of degree 4 for each class, through the boundary that is
 *            nearest to its centre; a class that has none stays its best ellipsoid. Fast; from level 4 on the mean error is
 *            a third to two thirds above that of joint */
typedef enum { ESKEL_FIT_JOINT, ESKEL_FIT_TABU, ESKEL_FIT_HOPPING, ESKEL_FIT_LEAST_SQUARES } eskel_fit_method;

/* What a fit may change beside centre, axes, radii and alpha; of least squares it says nothing. */
typedef enum {
	ESKEL_FIT_DEFORMED,                 /* exponents and all modes */
	ESKEL_FIT_DEFORMED_SIMPLY,          /* exponents, taper, bend and twist */
	ESKEL_FIT_SUPERQUADRIC,             /* exponents */
	ESKEL_FIT_ELLIPSOID                 /* nothing */
} eskel_fit_freedom;

typedef struct {
	eskel_fit_method method;
	eskel_fit_freedom freedom;
	uint32_t boundary_points;           /* that are fitted to, 8 to 1,000,000; default 1200 + 150 level */
	uint64_t seed;                      /* of tabu and hopping */
	uint32_t hops;                      /* hopping: default 10, at most 1000 */
	uint32_t tabu_neighbours;           /* t_n: default 5, at most 1000 */
	uint32_t tabu_memory;               /* t_v: default 10, at most 64 */
	uint32_t tabu_steps;                /* default 200, at most 1,000,000 */
	double tabu_threshold;              /* mm, root mean square: a class with less is done; default a quarter of a voxel */
	uint32_t threads;                   /* at most; default 1 */
	bool (*progress)(void *context, uint32_t step, uint32_t steps); /* now and then; false: ESKEL_CANCELLED */
	void *context;
} eskel_fit_options;

typedef struct {
	uint32_t level;
	eskel_surface *surface;             /* fitted; eskel_surface_encode makes its bytes, which need no cloud */
	eskel_surface_error before, after;  /* of the blend of best ellipsoids, alpha 1, and of the surface */
} eskel_reconstruction;

/* Fits a surface of the classes of a level to the cloud that the skeleton is of. ESKEL_INVALID unless it has the level and the
 * options are in range; ESKEL_TOO_LARGE as eskel_surface_errors. */
ESKEL_API eskel_status eskel_surface_fit(const eskel_cloud *cloud, const eskel_skeleton *skeleton, uint32_t level,
	const eskel_fit_options *options, eskel_reconstruction **reconstruction, eskel_error *error);
ESKEL_API void eskel_reconstruction_free(eskel_reconstruction *reconstruction);

#endif
