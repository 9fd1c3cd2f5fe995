/* The commands on a database beside serving it: tokens and the audit. Each returns the exit status. */
#ifndef ESK_ADMINISTER_H
#define ESK_ADMINISTER_H

#include "options.h"

int esk_administer(const esk_options *options);

#endif
