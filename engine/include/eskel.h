/* eskel: shapes as ellipsoidal skeletons.
 *
 * The engine, in the order of its pipeline: a volume is decoded into clouds of voxels, a cloud becomes a
 * skeleton, a skeleton has a signature, signatures are matched and searched, skeletons are compared for
 * handedness and laid on one another. Pure computation: nothing here opens a file, a socket or a database, prints, or keeps state
 * outside the objects that it returns. Each header beside this one has a part of it.
 *
 * Conventions, everywhere:
 * - World space is RAS (x to the right, y to the front, z to the head) in millimetres.
 * - A function that can fail returns an eskel_status and writes its outputs last: they are untouched on failure.
 * - An eskel_error is optional (NULL); it receives one sentence with the offending and the expected value.
 * - Objects made by a _new or _decode are owned by the caller and released by the matching _free, which takes NULL.
 * - Options are plain structs in which zero means the default, and NULL means all defaults.
 * - Results are the same for any number of threads and on any machine.
 *
 * "Section" refers to the paper: Banegas, Michelucci, Roelens, Jaeger, "The Ellipsoidal Skeleton in Medical
 * Applications".
 */
#ifndef ESKEL_H
#define ESKEL_H

#include "eskel_base.h"
#include "eskel_volume.h"
#include "eskel_skeleton.h"
#include "eskel_library.h"
#include "eskel_comparison.h"
#include "eskel_surface.h"

#endif
