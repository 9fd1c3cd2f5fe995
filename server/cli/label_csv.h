/* Tables of labels with a header, in CSV (csv.h), or with tabs in place of commas as in BIDS (dseg.tsv).
 *
 * The columns label, name, class and side are found by name in any order; label, or index, must be there, others are
 * ignored, and so are empty lines. A side may also be L, R or N. With tabs, n/a is nothing and the background's row is
 * passed over. */
#ifndef ESK_LABEL_CSV_H
#define ESK_LABEL_CSV_H

#include "label_names.h"

/* Adds the rows of names->csv. */
esk_outcome esk_label_csv_read(esk_label_names *names);

#endif
