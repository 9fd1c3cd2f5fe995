#include "volume_format.h"

#include "error.h"

#include <stdarg.h>
#include <stdio.h>

size_t esk_volume_voxel_size(const esk_volume_header *header)
{
	return (size_t)header->voxels.size * header->layer_count;
}

eskel_status esk_volume_check_extent(const uint32_t extent[3], uint64_t most, eskel_error *error)
{
	const uint64_t voxels = (uint64_t)extent[0] * extent[1] * extent[2]; /* at most 65535 each, so it fits */
	if (voxels <= most)
		return ESKEL_OK;
	return esk_error_set(error, ESKEL_TOO_LARGE, "the grid has %u x %u x %u = %llu voxels, expected at most %llu",
		extent[0], extent[1], extent[2], (unsigned long long)voxels, (unsigned long long)most);
}

void eskel_volume_warn(eskel_volume_info *info, eskel_warning_code code, const char *format, ...)
{
	if (info->warning_count == ESKEL_VOLUME_WARNINGS_MAX)
		return;
	eskel_warning *warning = &info->warnings[info->warning_count++];
	va_list arguments;
	va_start(arguments, format);
	warning->code = code;
	vsnprintf(warning->text, sizeof warning->text, format, arguments);
	va_end(arguments);
}
