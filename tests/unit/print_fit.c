/* Prints a joint fit for fit_oracle.py: what it looks at, where it starts, where it ends and at what cost.
 *
 *	print_fit LEVEL POINTS */
#include "joint_fit.h"
#include "shapes.h"
#include "surface.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void give_up(const char *what)
{
	fprintf(stderr, "%s\n", what);
	exit(1);
}

static void print_points(const esk_fit_points *points)
{
	for (size_t g = 0; g < points->group_count; g++)
		for (int l = 0; l < ESK_LANES; l++) {
			const esk_fit_group *group = &points->groups[g];
			if (group->weights[l] > 0)
				printf("point %d %.17g %.17g %.17g %.17g %.17g\n", group->kind, group->points[0][l],
					group->points[1][l], group->points[2][l], group->margins[l], group->weights[l]);
		}
}

static void print_primitives(const char *name, const eskel_primitive *primitives, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		const eskel_primitive *p = &primitives[i];
		printf("%s", name);
		for (int r = 0; r < 3; r++)
			printf(" %.17g", p->centre[r]);
		for (int r = 0; r < 9; r++)
			printf(" %.17g", p->axes[r / 3][r % 3]);
		for (int r = 0; r < 3; r++)
			printf(" %.17g", p->radii[r]);
		for (int m = 0; m <= ESKEL_MODE_TWIST; m++)
			printf(" %.17g", p->modes[m]);
		printf(" %.17g %.17g %.17g\n", p->alpha, p->exponents[0], p->exponents[1]);
	}
}

int main(int count, char **arguments)
{
	if (count != 3)
		give_up("print_fit LEVEL POINTS");
	const uint32_t level = (uint32_t)atoi(arguments[1]);
	shapes_solid solid = shapes_hamate;
	solid.scale = 0.6;
	eskel_cloud *cloud = shapes_cloud(&solid, &shapes_identity);
	eskel_skeleton *skeleton = NULL;
	eskel_surface *plain = NULL;
	esk_boundary *boundary = NULL;
	esk_fit_points *points = NULL;
	eskel_primitive fitted[ESKEL_LEVELS_MAX];
	double cost;
	if (eskel_skeleton_new(cloud, NULL, &skeleton, NULL) || esk_boundary_new(cloud, &boundary, NULL) ||
		eskel_surface_new(
			skeleton, level, &(eskel_surface_options){.primitive = ESKEL_PRIMITIVE_DEFORMED}, &plain) ||
		esk_fit_points_new(boundary, (size_t)atoi(arguments[2]), &points))
		give_up("no start");
	const esk_joint_options options = {.freedom = ESKEL_FIT_DEFORMED_SIMPLY, .spacing = boundary->spacing};
	memcpy(fitted, plain->primitives, sizeof fitted);
	if (esk_joint_fit(points, &options, level, plain->primitives, fitted, &cost))
		give_up("no fit");
	printf("length %.17g\nspacing %.17g\ncost %.17g\n", points->length, boundary->spacing, cost);
	print_points(points);
	print_primitives("start", plain->primitives, level);
	print_primitives("end", fitted, level);
	esk_fit_points_free(points);
	esk_boundary_free(boundary);
	eskel_surface_free(plain);
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
	return 0;
}
