/* What readers of a library use: a snapshot of it. */
#ifndef ESK_LIBRARY_H
#define ESK_LIBRARY_H

#include "neighbourhood.h"
#include "snapshot.h"

/* Never waits for more than the exchange of a few words. Release with esk_directory_release(snapshot.directory). */
esk_snapshot esk_library_snapshot(const eskel_library *library);

/* What is known of the neighbourhoods of its shapes. */
esk_neighbourhoods *esk_library_neighbourhoods(const eskel_library *library);

#endif
