/* The real bones and atlases that tests may find beside the checkout and on the system. */
#ifndef REAL_DATA_H
#define REAL_DATA_H

#include "eskel.h"

#define REAL_DATA "../shared/data/"
#define REAL_ATLAS "/usr/share/mricron/templates/aal.nii.gz" /* Debian package mricron-data */
#define REAL_ATLAS_NAMES "/usr/share/mricron/templates/aal.nii.txt"

typedef struct {
	char name[96], subject[32], class_name[64], side[16]; /* side is left, right or none */
	eskel_cloud *cloud;
	eskel_skeleton *skeleton;
	eskel_signature *signature;
} real_shape;

typedef struct {
	size_t count;
	real_shape *shapes;
} real_set;

/* These exit with a message when a file is there and cannot be used. */

eskel_volume *real_volume(const char *path);
/* Of the cloud, which it takes, with the default options. */
void real_shape_compute(real_shape *shape, eskel_cloud *cloud);
/* The single object of a volume. */
void real_shape_read(real_shape *shape, const char *path);
void real_shape_clear(real_shape *shape);

/* Every single-bone volume of the manifest; every region of the atlas, whose names end in _L or _R where it has sides. */
real_set real_bones(void);
real_set real_regions(void);
void real_set_clear(real_set *set);

bool real_file_exists(const char *path);

#endif
