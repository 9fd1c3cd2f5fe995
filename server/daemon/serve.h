/* The daemon's life: open, serve, drain, close. */
#ifndef ESK_SERVE_H
#define ESK_SERVE_H

#include "options.h"

/* Serves until SIGTERM or SIGINT; the exit status. */
int esk_serve(const esk_options *options);

#endif
