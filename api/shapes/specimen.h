/* The labels of a posted volume, each on its way from voxels to a shape. */
#ifndef ESK_SPECIMEN_H
#define ESK_SPECIMEN_H

#include "exchange.h"

/* One label: as a shape that is not stored (shape.created is "", its key 0), with what the shape is made of. */
typedef struct {
	eskel_cloud *cloud;
	unsigned border;          /* sides of the grid that it touches (eskel_volume_border) */
	eskel_skeleton *skeleton; /* NULL until esk_specimens_analyse */
	eskel_signature *signature;
	eskel_shape shape;
} esk_specimen;

typedef struct {
	size_t count;
	esk_specimen *items;
	size_t warning_count; /* of the volume, which every label shares */
	eskel_warning warnings[ESKEL_VOLUME_WARNINGS_MAX];
} esk_specimens;

/* Finishes the exchange's volume and takes the labels that are asked for (all without a label parameter), ascending, with
 * their ids and with what is said of them; the volume is freed. said is the exchange's query or a part of it. */
bool esk_specimens_take(eskel_exchange *exchange, const esk_parameters *said, esk_specimens *specimens);
/* Where class, side and so on choose the shapes to compare with, the query says of its labels only what name and label.N
 * say. */
bool esk_specimens_take_unknown(eskel_exchange *exchange, esk_specimens *specimens);
void esk_specimens_clear(esk_specimens *specimens);

/* Computes the skeletons of the levels asked for, the signatures and the warnings of those without one that are wanted
 * (NULL: all), on all processors. What refuses is the first that fails. */
bool esk_specimens_analyse(esk_specimens *specimens, const bool *wanted, uint32_t levels, esk_problem *problem);

/* For esk_specimens_analyse: the warnings of the volume, and what the label itself gives reason for. False when memory ran
 * out. */
bool esk_specimen_warn(esk_specimen *specimen, const esk_specimens *specimens, uint32_t levels);

#endif
