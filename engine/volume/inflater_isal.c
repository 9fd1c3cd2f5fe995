/* ISA-L differs from what inflater.h promises at the end of a stream and at a fault.
 *
 * It reads whole words, so at the end of a stream it has taken up to a word too much, which is given back. All of that
 * belongs to the piece of input that it was last given: every piece before was used up, but for symbols that the
 * piece's end made incomplete.
 *
 * At a fault its fast loop may count bytes as written that it has not (it counts a copy before it looks whether the
 * copy is possible). Only its other loop, for the end of a piece, where there is no whole word to read, stops right at a
 * fault. So the state is kept before each call, which costs little beside what a call inflates, and when the call finds a
 * fault, all is done again from there with less than a word of input at a time. What was inflated before the fault may
 * then still wait in ISA-L's own buffer for room: it is handed out before the fault is told.
 */
#include "inflater.h"

#include "memory.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { less_than_a_word = 7 };

struct esk_inflater {
	struct inflate_state state, before;
	bool careful; /* a fault lies ahead */
	bool faulty;  /* it is reached */
};

eskel_status esk_inflater_new(esk_inflater **inflater)
{
	esk_inflater *f = esk_memory_array(1, sizeof *f); /* not zeroed: few of its 180 KB are used for little data */
	if (!f)
		return ESKEL_NO_MEMORY;
	isal_inflate_init(&f->state);
	f->careful = false;
	f->faulty = false;
	*inflater = f;
	return ESKEL_OK;
}

void esk_inflater_free(esk_inflater *inflater)
{
	free(inflater);
}

void esk_inflater_begin(esk_inflater *inflater)
{
	isal_inflate_reset(&inflater->state);
	inflater->careful = false;
	inflater->faulty = false;
}

static uint32_t clamp(size_t size)
{
	return size < UINT32_MAX ? (uint32_t)size : UINT32_MAX;
}

/* Without what lies in tmp_out_buffer, the last member, behind the valid bytes. */
static void copy_state(struct inflate_state *to, const struct inflate_state *from)
{
	memcpy(to, from, offsetof(struct inflate_state, tmp_out_buffer) + (size_t)from->tmp_out_valid);
}

static int inflate_carefully(struct inflate_state *s)
{
	uint32_t left = s->avail_in;
	int result;
	do {
		s->avail_in = left < less_than_a_word ? left : less_than_a_word;
		left -= s->avail_in;
		result = isal_inflate(s);
		left += s->avail_in; /* not taken: out is full */
	} while (result == ISAL_DECOMP_OK && left > 0 && s->avail_out > 0);
	s->avail_in = left;
	return result;
}

static int inflate_some(esk_inflater *f)
{
	if (f->careful)
		return inflate_carefully(&f->state);
	copy_state(&f->before, &f->state);
	int result = isal_inflate(&f->state);
	if (result == ISAL_DECOMP_OK)
		return result;
	copy_state(&f->state, &f->before);
	f->careful = true;
	return inflate_carefully(&f->state);
}

/* Hands out what was inflated before the fault; whether there is no more. */
static bool drain(struct inflate_state *s)
{
	uint32_t left = (uint32_t)(s->tmp_out_valid - s->tmp_out_processed);
	uint32_t size = left < s->avail_out ? left : s->avail_out;
	memcpy(s->next_out, s->tmp_out_buffer + s->tmp_out_processed, size);
	s->tmp_out_processed += (int32_t)size;
	s->next_out += size;
	s->avail_out -= size;
	return size == left;
}

eskel_status esk_inflater_run(esk_inflater *inflater, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, bool *ended)
{
	struct inflate_state *s = &inflater->state;
	s->next_in = (uint8_t *)*in;
	s->avail_in = clamp(*in_size);
	s->next_out = out;
	s->avail_out = clamp(out_size);
	if (!inflater->faulty)
		inflater->faulty = inflate_some(inflater) != ISAL_DECOMP_OK;
	bool drained = inflater->faulty && drain(s);
	*ended = s->block_state == ISAL_BLOCK_FINISH;
	if (*ended)
		s->next_in -= s->read_in_length / 8;
	*in_size -= (size_t)(s->next_in - *in);
	*in = s->next_in;
	*out_used = (size_t)(s->next_out - out);
	return drained ? ESKEL_MALFORMED : ESKEL_OK;
}

uint32_t esk_inflater_crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
	return crc32_gzip_refl(crc, bytes, size);
}

uint32_t esk_inflater_adler32(uint32_t adler, const uint8_t *bytes, size_t size)
{
	return isal_adler32(adler, bytes, size);
}
