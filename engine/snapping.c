#include "snapping.h"

#include <math.h>

#define SHORT 1.7320508075688772 /* sqrt(3) */
#define LONG 2.0
/* Of an edge, how near to a node a cut must be. Up to these the tetrahedra around a moved node keep their orientation, so that
 * triangles do not cross: they are the largest for which the paper proves good angles. */
#define NEAR_SHORT 0.41189
#define NEAR_LONG 0.24999

/* By direction: in step_half, and in parts of the edge. */
static const double edge_lengths[ESK_DIRECTIONS] = {SHORT, SHORT, LONG, SHORT, LONG, LONG, SHORT};
static const double near_parts[ESK_DIRECTIONS] = {
	NEAR_SHORT, NEAR_SHORT, NEAR_LONG, NEAR_SHORT, NEAR_LONG, NEAR_LONG, NEAR_SHORT};

/* The values at the ends of an edge are as far from 0 as, to first order, they are from the cut. */
static bool is_near(const esk_trace *trace, const esk_active *active)
{
	const double value = fabs(trace->lattice.values[active->node]);
	bool near = false;
	for (unsigned rest = active->cut; rest; rest &= rest - 1) {
		const int slot = __builtin_ctz(rest);
		const double other = fabs(trace->lattice.values[active->neighbours[slot]]);
		near |= value <= near_parts[slot % ESK_DIRECTIONS] * (value + other);
	}
	return near;
}

static uint8_t nearest_cut(const esk_trace *trace, const esk_active *active)
{
	const double value = trace->lattice.values[active->node];
	double least = INFINITY;
	int nearest = __builtin_ctz(active->cut);
	for (unsigned rest = active->cut; rest; rest &= rest - 1) {
		const int slot = __builtin_ctz(rest);
		const double part = value / (value - trace->lattice.values[active->neighbours[slot]]);
		if (part * edge_lengths[slot % ESK_DIRECTIONS] < least) {
			least = part * edge_lengths[slot % ESK_DIRECTIONS];
			nearest = slot;
		}
	}
	return (uint8_t)nearest;
}

/* Whether the slots of a set are connected in the link. */
static bool is_connected(const esk_star *star, unsigned set)
{
	unsigned reached = set & -set, fresh = reached;
	while (fresh) {
		unsigned next = 0;
		for (; fresh; fresh &= fresh - 1)
			next |= star->adjacent[__builtin_ctz(fresh)];
		fresh = next & set & ~reached;
		reached |= fresh;
	}
	return reached == set;
}

/* Whether the strip to the snapped neighbour in a slot is one. */
static bool is_strip(const esk_star *star, int slot, unsigned inside, unsigned snapped)
{
	int changes = 0; /* of side, along the ring */
	for (int e = 0; e < 6; e++) {
		const unsigned edge = star->rings[slot][e] & inside;
		changes += edge && edge != star->rings[slot][e];
	}
	const unsigned rest = star->adjacent[slot] & ~inside;
	const bool is_pillow = rest && !(rest & (rest - 1)) && (rest & snapped);
	return changes <= 2 && !is_pillow;
}

static bool may_snap(const esk_star *star, unsigned inside, unsigned snapped)
{
	const unsigned outside = ~inside & ((1u << ESK_NEIGHBOURS) - 1);
	if (!inside || !outside || !is_connected(star, inside) || !is_connected(star, outside))
		return false;
	for (unsigned rest = snapped; rest; rest &= rest - 1)
		if (!is_strip(star, __builtin_ctz(rest), inside, snapped))
			return false;
	return true;
}

static bool breaks_rules(const esk_star *star, const uint8_t *states, const esk_active *active)
{
	unsigned inside = 0, snapped = 0;
	for (int s = 0; s < ESK_NEIGHBOURS; s++) {
		const unsigned state = states[active->neighbours[s]];
		inside |= (state & ESK_INSIDE) << s;
		snapped |= (state / ESK_SNAPPED & 1) << s;
	}
	return !may_snap(star, inside, snapped);
}

/* All at once, so that no order matters. Whether there was one. */
static bool release_breakers(const esk_trace *trace, const esk_star *star, uint8_t *states)
{
	enum { BREAKS = 8 };
	bool any = false;
	for (size_t n = 0; n < trace->count; n++) {
		const esk_active *active = &trace->actives[n];
		if (states[active->node] & ESK_SNAPPED && breaks_rules(star, states, active)) {
			states[active->node] |= BREAKS;
			any = true;
		}
	}
	for (size_t n = 0; n < trace->count && any; n++) {
		const uint32_t node = trace->actives[n].node;
		if (states[node] & BREAKS)
			states[node] = ESK_ACTIVE | (esk_trace_inside(trace, node) ? ESK_INSIDE : 0);
	}
	return any;
}

void esk_snap(const esk_trace *trace, const esk_star *star, uint8_t *states, uint8_t *cuts)
{
	for (size_t n = 0; n < trace->lattice.node_count; n++)
		states[n] = esk_trace_inside(trace, (uint32_t)n) ? ESK_INSIDE : 0;
	for (size_t n = 0; n < trace->count; n++) {
		const esk_active *active = &trace->actives[n];
		uint8_t *state = &states[active->node];
		*state = is_near(trace, active) ? ESK_ACTIVE | ESK_SNAPPED : ESK_ACTIVE | *state;
	}
	while (release_breakers(trace, star, states))
		;
	for (size_t n = 0; n < trace->count; n++)
		if (states[trace->actives[n].node] & ESK_SNAPPED)
			cuts[n] = nearest_cut(trace, &trace->actives[n]);
}
