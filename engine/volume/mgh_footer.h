/* What lies behind the voxels of an MGH file, of which the names of labels matter. */
#ifndef ESK_MGH_FOOTER_H
#define ESK_MGH_FOOTER_H

#include "volume_format.h"

/* Adds the names of the colour table to the header's segments or, where there is none, FreeSurfer's standard names of the
 * labels found, with a warning. A footer that breaks off ends the names, with a warning. */
esk_footer_reader esk_mgh_footer_read;

#endif
