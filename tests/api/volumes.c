#include "volumes.h"

#include "nifti_file.h"

#include <stdio.h>
#include <stdlib.h>

static int is_inside(const blob *b, double x, double y, double z)
{
	double side = b->mirrored ? -1 : 1;
	double t = z / b->length, bent = side * x - 0.3 * b->width * t * t, radius = b->width * (1 - 0.25 * t);
	double rod = t * t + bent * bent / (radius * radius) + y * y / (0.5 * radius * radius);
	double dx = side * x - b->width, dy = y - 0.5 * b->width, dz = z - 0.6 * b->length;
	return rod <= 1 || dx * dx + dy * dy + dz * dz <= b->knob * b->knob;
}

volume_file volume_of_blobs(const blob *blobs, size_t count, unsigned extent)
{
	enum { unsigned_char = 2 };
	const nifti_file header = nifti_file_new(1, false, unsigned_char, (int)extent, (int)extent, (int)extent);
	size_t voxels = (size_t)extent * extent * extent;
	double *values = calloc(voxels, sizeof *values), *value = values;
	volume_file file = {0};
	for (unsigned z = 0; values && z < extent; z++)
		for (unsigned y = 0; y < extent; y++)
			for (unsigned x = 0; x < extent; x++, value++)
				for (size_t i = 0; i < count; i++)
					if (is_inside(&blobs[i], x - blobs[i].centre[0], y - blobs[i].centre[1],
						    z - blobs[i].centre[2]))
						*value = blobs[i].label;
	if (values)
		file.bytes = nifti_file_write(&header, values, voxels, &file.size);
	free(values);
	if (!file.bytes) {
		fprintf(stderr, "no memory for a volume\n");
		exit(2);
	}
	return file;
}

void volume_free(volume_file *file)
{
	free(file->bytes);
	*file = (volume_file){0};
}

blob blob_of_family(unsigned family, unsigned member)
{
	double more = 1 + 0.01 * member;
	return (blob){
		.label = 1,
		.length = (10 + 2.5 * (family % 4)) * more,
		.width = 5 + family / 4 % 3,
		.knob = (4 + 1.5 * (family / 12 % 3)) / more,
		.centre = {24, 24, 22},
	};
}

volume_file volume_of_family(unsigned family, unsigned member, int mirrored)
{
	blob b = blob_of_family(family, member);
	b.mirrored = mirrored;
	return volume_of_blobs(&b, 1, 48);
}
