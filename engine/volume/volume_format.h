/* What a volume file's header says, whatever its format: what the voxel decoder needs to know of it. */
#ifndef ESK_VOLUME_FORMAT_H
#define ESK_VOLUME_FORMAT_H

#include "decompressor.h"
#include "run_builder.h"
#include "segments.h"
#include "voxel.h"

typedef struct esk_volume_header esk_volume_header;

/* Reads all that follows the last voxel, at most 2^20 bytes, when the labels are known. */
typedef eskel_status esk_footer_reader(const uint8_t *bytes, size_t size, const esk_label_table *labels,
	esk_volume_header *header, eskel_error *error);

struct esk_volume_header {
	eskel_volume_info info;  /* all but gzipped */
	esk_voxel_format voxels; /* x fastest, then y, then z */
	uint32_t layer_count;    /* more than 1: a voxel is as many values, of the segments' layers */
	bool text;               /* numbers between blanks, which become 64-bit floats of this machine's order */
	bool compressed;         /* the voxels alone, behind the header */
	esk_compression compression;
	uint64_t data_offset;           /* of the first voxel, in bytes from the start of the file */
	esk_footer_reader *read_footer; /* NULL: nothing may follow the last voxel */
	esk_segments segments;
};

/* The bytes of a voxel, of all layers. */
size_t esk_volume_voxel_size(const esk_volume_header *header);
/* ESKEL_TOO_LARGE for a grid of more than most voxels. */
eskel_status esk_volume_check_extent(const uint32_t extent[3], uint64_t most, eskel_error *error);

/* Reads the header from the first size bytes of a file, at least 4. When it wants more it returns ESKEL_OK with
 * *needed > size, at most 2^20, and header untouched: it is then called with so many, and where a format is of lines with
 * each more line. Otherwise *needed <= size and header is complete: every extent 1 to 65535, the affine checked; its segments
 * are the caller's to clear. ESKEL_NOT_VOLUME, without a sentence, for another format's bytes. */
typedef eskel_status esk_header_reader(
	const uint8_t *bytes, size_t size, size_t *needed, esk_volume_header *header, eskel_error *error);

esk_header_reader esk_nifti_read_header, esk_nrrd_read_header, esk_metaimage_read_header, esk_mgh_read_header;

#endif
