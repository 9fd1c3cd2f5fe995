/* What became of many files: how many were added, were there, were refused and why. */
#ifndef ESK_BULK_SUMMARY_H
#define ESK_BULK_SUMMARY_H

#include "bulk.h"

/* Counts and refusals for people. */
void esk_bulk_summary_write(const esk_bulk *bulk, FILE *out);

/* The refusals as CSV with the columns path and reason. */
esk_outcome esk_bulk_summary_write_refused(const esk_bulk *bulk, const char *path);

#endif
