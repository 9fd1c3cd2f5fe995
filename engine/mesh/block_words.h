/* A bit for each node of a block of 4 x 4 x 4: node (x, y, z) is bit 16 x + 4 y + z. Steps between nodes are shifts.
 *
 * Around a block there are 7 blocks forward and 7 back, in the directions of the lattice (lattice.h), and in slots as there;
 * the block itself is in the slot ESK_OWN. Axes are gone along one after the other, which a direction's mask allows: after
 * axis a, bit a of an index no longer tells the block but the step. */
#ifndef ESK_BLOCK_WORDS_H
#define ESK_BLOCK_WORDS_H

#include <stdbool.h>
#include <stdint.h>

enum { ESK_OWN = 14, ESK_AROUND = 15 };

/* The first layer across an axis, and how far apart layers are. */
static const uint64_t esk_first_layers[3] = {0xffff, 0x000f000f000f000f, 0x1111111111111111};
static const int esk_layer_steps[3] = {16, 4, 1};

/* The slot of the block in the direction of a mask of axes, or against it; mask 0 is no step. */
static inline int esk_slot_of(int mask, bool back)
{
	return mask == 0 ? ESK_OWN : mask - 1 + (back ? 7 : 0);
}

static inline int esk_slot_opposite(int slot)
{
	return slot < 7 ? slot + 7 : slot - 7;
}

/* From words by slot, those around a node by slot: bit n of near[s] is that of the node's neighbour in slot s. */
static inline void esk_words_gather(const uint64_t words[ESK_AROUND], bool back, uint64_t near[ESK_AROUND])
{
	uint64_t w[8];
	for (int m = 0; m < 8; m++)
		w[m] = words[esk_slot_of(m, back)];
	for (int a = 0; a < 3; a++) {
		const int step = esk_layer_steps[a];
		const uint64_t first = esk_first_layers[a], last = first << 3 * step;
		for (int m = 0; m < 8; m++)
			if (m >> a & 1) {
				const uint64_t here = w[m & ~(1 << a)], next = w[m];
				w[m] = back ? (here << step & ~first) | (next >> 3 * step & first)
					    : (here >> step & ~last) | (next << 3 * step & last);
			}
	}
	for (int m = 0; m < 8; m++)
		near[esk_slot_of(m, back)] = w[m];
}

/* A bit for each neighbour of a node of the block, after gathering both ways. */
static inline unsigned esk_words_bits(const uint64_t near[ESK_AROUND], int place)
{
	uint64_t bits = 0;
	for (int s = 0; s < ESK_OWN; s++)
		bits |= (near[s] >> place & 1) << s;
	return (unsigned)bits;
}

/* The other way round: adds the nodes of a block, and their neighbours forward, or back, to words by slot. */
static inline void esk_words_spread_one_way(uint64_t word, bool back, uint64_t words[ESK_AROUND])
{
	uint64_t w[8] = {word};
	for (int a = 0; a < 3; a++) {
		const int step = esk_layer_steps[a];
		const uint64_t first = esk_first_layers[a], last = first << 3 * step;
		for (int m = 0; m < 1 << a; m++) {
			const uint64_t here = w[m];
			w[m] |= back ? (here & ~first) >> step : (here & ~last) << step;
			w[m | 1 << a] = back ? (here & first) << 3 * step : (here & last) >> 3 * step;
		}
	}
	for (int m = 0; m < 8; m++)
		words[esk_slot_of(m, back)] |= w[m];
}

/* Nodes of a block, and their neighbours in it. */
static inline uint64_t esk_word_spread(uint64_t word)
{
	uint64_t forward = word, back = word;
	for (int a = 0; a < 3; a++) {
		const int step = esk_layer_steps[a];
		const uint64_t first = esk_first_layers[a], last = first << 3 * step;
		forward |= (forward & ~last) << step;
		back |= (back & ~first) >> step;
	}
	return forward | back;
}

static inline void esk_words_spread(uint64_t word, uint64_t words[ESK_AROUND])
{
	for (int s = 0; s < ESK_AROUND; s++)
		words[s] = 0;
	esk_words_spread_one_way(word, false, words);
	esk_words_spread_one_way(word, true, words);
}

#endif
