#include "star.h"

static void make_tetrahedra(esk_star *star)
{
	/* The axes in the order in which a path goes along them; every other order is odd. */
	static const uint8_t orders[ESK_TETRAHEDRA][3] = {
		{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};
	for (int t = 0; t < ESK_TETRAHEDRA; t++) {
		esk_tetrahedron *made = &star->tetrahedra[t];
		*made = (esk_tetrahedron){.set = 1, .reversed = t % 2};
		for (int c = 1; c < 4; c++) {
			made->corners[c] = (uint8_t)(made->corners[c - 1] | 1u << orders[t][c - 1]);
			made->set = (uint8_t)(made->set | 1u << made->corners[c]);
		}
	}
}

/* The slot that leads from one corner of Kuhn's path to another. */
static int slot_between(int from, int to)
{
	return from < to ? esk_slot_of(to & ~from, false) : esk_slot_of(from & ~to, true);
}

/* The triangle opposite to the node, which is a corner of a tetrahedron. */
static uint16_t opposite(const esk_tetrahedron *tetrahedron, int corner)
{
	unsigned slots = 0;
	for (int c = 0; c < 4; c++)
		if (c != corner)
			slots |= 1u << slot_between(tetrahedron->corners[corner], tetrahedron->corners[c]);
	return (uint16_t)slots;
}

void esk_star_make(esk_star *star)
{
	int counts[ESK_NEIGHBOURS] = {0};
	*star = (esk_star){0};
	make_tetrahedra(star);
	for (int t = 0; t < ESK_STAR; t++) {
		const unsigned triangle = opposite(&star->tetrahedra[t / 4], t % 4);
		for (int s = 0; s < ESK_NEIGHBOURS; s++) {
			const uint16_t edge = (uint16_t)(triangle & ~(1u << s));
			if (!(triangle >> s & 1))
				continue;
			star->adjacent[s] |= edge;
			star->rings[s][counts[s]++] = edge;
		}
	}
}
