#include "data_set.h"

#include "grid.h"
#include "pixels.h"
#include "refusal.h"
#include "segment_name.h"

#include <stdlib.h>

static eskel_status name_segments(const esk_segmentation *segmentation, eskel_volume *volume, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	for (size_t i = 0; i < segmentation->segment_count && status == ESKEL_OK; i++) {
		const esk_dicom_segment *segment = &segmentation->segments[i];
		char name[ESK_SEGMENT_NAME];
		esk_segment_name(segment, name);
		if (name[0] && segment->number != 0)
			status = eskel_volume_name_label(volume, segment->number, name, error);
	}
	return status;
}

static eskel_status read_segmentation(
	esk_window *window, esk_segmentation *segmentation, eskel_volume *volume, eskel_error *error)
{
	uint32_t pixel_bytes;
	eskel_volume_info info;
	eskel_status status = esk_segmentation_read(window, segmentation, &pixel_bytes, error);
	if (status == ESKEL_OK)
		status = esk_grid_fit(segmentation, &info, error);
	if (status == ESKEL_OK)
		status = eskel_volume_begin_runs(volume, &info, error);
	if (status == ESKEL_OK)
		status = name_segments(segmentation, volume, error);
	return status == ESKEL_OK ? esk_pixels_read(window, segmentation, volume, error) : status;
}

eskel_status esk_data_set_read(esk_window_source *get, void *source, eskel_volume *volume, eskel_error *error)
{
	esk_segmentation segmentation = {0};
	esk_window *window = calloc(1, sizeof *window);
	if (!window)
		return esk_refuse(error, ESKEL_NO_MEMORY, "memory ran out for DICOM");
	window->get = get;
	window->source = source;
	eskel_status status = read_segmentation(window, &segmentation, volume, error);
	esk_segmentation_clear(&segmentation);
	free(window);
	return status;
}
