#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "gzip.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { largest = 300000, text = 1, header_checksum = 2, extra = 4, name = 8, comment = 16 };

typedef struct {
	uint8_t bytes[largest];
	size_t size;
} buffer;

static void put(buffer *b, const void *bytes, size_t size)
{
	assert_true(size <= largest - b->size);
	memcpy(b->bytes + b->size, bytes, size);
	b->size += size;
}

static void put_number(buffer *b, uint32_t number, size_t size)
{
	for (size_t i = 0; i < size; i++)
		put(b, &(uint8_t){(uint8_t)(number >> 8 * i)}, 1);
}

/* The fields that the flags tell of; the extra field has extra_size bytes. */
static void put_header(buffer *b, uint8_t flags, uint16_t extra_size)
{
	size_t begin = b->size;
	put(b, (uint8_t[]){0x1f, 0x8b, 8, flags, 1, 2, 3, 4, 0, 255}, 10);
	if (flags & extra) {
		put_number(b, extra_size, 2);
		for (unsigned i = 0; i < extra_size; i++)
			put_number(b, i % 3, 1);
	}
	if (flags & name)
		put(b, "a name", sizeof "a name");
	if (flags & comment)
		put(b, "", 1);
	if (flags & header_checksum)
		put_number(b, (uint32_t)crc32_z(0, b->bytes + begin, b->size - begin), 2);
}

static void put_trailer(buffer *b, const uint8_t *data, size_t size)
{
	put_number(b, (uint32_t)crc32_z(0, data, size), 4);
	put_number(b, (uint32_t)size, 4);
}

/* Deflates data that may refer back to a dictionary; flush: Z_FINISH, or Z_SYNC_FLUSH to leave the stream open. */
static void put_deflated(
	buffer *b, const uint8_t *data, size_t size, int level, int strategy, const buffer *dictionary, int flush)
{
	z_stream z = {0};
	assert_int_equal(deflateInit2(&z, level, Z_DEFLATED, -15, 8, strategy), Z_OK);
	if (dictionary)
		assert_int_equal(deflateSetDictionary(&z, dictionary->bytes, (uInt)dictionary->size), Z_OK);
	z.next_in = (z_const Bytef *)data;
	z.avail_in = (uInt)size;
	z.next_out = b->bytes + b->size;
	z.avail_out = (uInt)(largest - b->size);
	assert_int_equal(deflate(&z, flush), flush == Z_FINISH ? Z_STREAM_END : Z_OK);
	b->size += z.total_out;
	deflateEnd(&z);
}

static void put_member(buffer *b, uint8_t flags, const uint8_t *data, size_t size)
{
	put_header(b, flags, 5);
	put_deflated(b, data, size, 6, Z_DEFAULT_STRATEGY, NULL, Z_FINISH);
	put_trailer(b, data, size);
}

/* Words that recur near and far, among noise. */
static void fill(buffer *b, size_t size, uint64_t seed)
{
	b->size = size;
	for (size_t i = 0; i < size; i++) {
		seed = seed * 6364136223846793005u + 1442695040888963407u;
		size_t back = seed >> 33 & 1 ? 7 : 31000;
		b->bytes[i] = (seed >> 40) % 8 && i >= back ? b->bytes[i - back] : (uint8_t)(seed >> 56);
	}
}

/* Inflates what comes in pieces, through a window; what comes out before a fault counts. */
static eskel_status inflate_all(
	const uint8_t *bytes, size_t size, size_t piece, size_t window, buffer *out, bool *complete)
{
	esk_gzip *gzip = NULL;
	assert_int_equal(esk_gzip_new(&gzip), ESKEL_OK);
	uint8_t *room = malloc(window); /* of that size, for the address sanitizer */
	assert_non_null(room);
	out->size = 0;
	eskel_status status = ESKEL_OK;
	for (size_t at = 0; at < size && status == ESKEL_OK; at += piece) {
		const uint8_t *in = bytes + at;
		size_t left = piece < size - at ? piece : size - at, used;
		do {
			status = esk_gzip_inflate(gzip, &in, &left, room, window, &used, NULL);
			put(out, room, used);
		} while (status == ESKEL_OK && (left > 0 || used == window));
	}
	*complete = esk_gzip_is_complete(gzip);
	free(room);
	esk_gzip_free(gzip);
	return status;
}

static const size_t pieces[] = {largest, 1000, 3, 1}, windows[] = {262144, 65536, 4096, 61};

static void assert_inflates(const buffer *in, const buffer *expected, eskel_status status)
{
	static buffer out;
	for (size_t p = 0; p < sizeof pieces / sizeof pieces[0] && in->size / pieces[p] < 10000; p++)
		for (size_t w = 0; w < sizeof windows / sizeof windows[0]; w++) {
			bool complete;
			assert_int_equal(
				inflate_all(in->bytes, in->size, pieces[p], windows[w], &out, &complete), status);
			assert_true(complete || status != ESKEL_OK);
			assert_int_equal(out.size, expected->size);
			assert_memory_equal(out.bytes, expected->bytes, expected->size);
		}
}

static bool is_taken(const buffer *in, size_t size, size_t piece)
{
	static buffer out;
	bool complete;
	return inflate_all(in->bytes, size, piece, 4096, &out, &complete) == ESKEL_OK && complete;
}

static void every_combination_of_header_fields_is_read(void **state)
{
	(void)state;
	static buffer data, in;
	fill(&data, 2000, 1);
	for (uint8_t flags = 0; flags < 32; flags++)
		for (uint16_t extra_size = 0; extra_size < 300; extra_size += 149) {
			in.size = 0;
			put_header(&in, flags, extra_size);
			put_deflated(&in, data.bytes, data.size, 6, Z_DEFAULT_STRATEGY, NULL, Z_FINISH);
			put_trailer(&in, data.bytes, data.size);
			assert_inflates(&in, &data, ESKEL_OK);
		}
}

static void every_kind_of_block_is_inflated(void **state)
{
	(void)state;
	static const struct {
		int level, strategy;
	} kinds[] = {{0, Z_DEFAULT_STRATEGY}, {6, Z_FIXED}, {1, Z_DEFAULT_STRATEGY}, {9, Z_DEFAULT_STRATEGY},
		{6, Z_HUFFMAN_ONLY}, {6, Z_RLE}};
	static const size_t sizes[] = {0, 1, 258, 32768, 65536, 200000};
	static buffer data, in;
	for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
		for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
			fill(&data, sizes[s], k + 1);
			in.size = 0;
			put_header(&in, 0, 0);
			put_deflated(&in, data.bytes, data.size, kinds[k].level, kinds[k].strategy, NULL, Z_FINISH);
			put_trailer(&in, data.bytes, data.size);
			assert_inflates(&in, &data, ESKEL_OK);
		}
}

static void a_long_stretch_of_one_value_is_inflated(void **state)
{
	(void)state;
	static buffer data = {.size = largest}, in;
	put_member(&in, 0, data.bytes, data.size);
	assert_inflates(&in, &data, ESKEL_OK);
}

static void members_are_joined(void **state)
{
	(void)state;
	static buffer data, in;
	fill(&data, 150000, 7);
	static const size_t ends[] = {0, 1, 30000, 30000, 150000}; /* two of the members are empty */
	for (size_t i = 0, begin = 0; i < 5; begin = ends[i++])
		put_member(&in, (uint8_t)(7 * i), data.bytes + begin, ends[i] - begin);
	assert_inflates(&in, &data, ESKEL_OK);
	data.bytes[0] ^= 1;
	put(&in, data.bytes, 1);
	data.bytes[0] ^= 1;
	assert_inflates(&in, &data, ESKEL_MALFORMED);
}

static void a_stream_is_complete_at_the_end_of_a_member_alone(void **state)
{
	(void)state;
	static buffer data, in;
	fill(&data, 300, 3);
	put_member(&in, extra | name | comment | header_checksum, data.bytes, data.size);
	size_t first = in.size;
	put_member(&in, 0, data.bytes, data.size);
	for (size_t size = 0; size <= in.size; size++)
		for (size_t p = 0; p < sizeof pieces / sizeof pieces[0]; p++)
			assert_int_equal(is_taken(&in, size, pieces[p]), size == first || size == in.size);
}

static void a_changed_byte_is_refused(void **state)
{
	(void)state;
	static buffer data, in;
	fill(&data, 300, 4);
	put_member(&in, extra | name | comment | header_checksum, data.bytes, data.size);
	for (size_t i = 0; i < in.size; i++) {
		in.bytes[i] ^= 0xff;
		assert_false(is_taken(&in, in.size, largest));
		in.bytes[i] ^= 0xff;
	}
}

static void without_a_checksum_the_header_may_say_any_time_and_system(void **state)
{
	(void)state;
	static buffer data, in;
	fill(&data, 300, 4);
	put_member(&in, 0, data.bytes, data.size);
	for (size_t bit = 0; bit < 8 * 10; bit++) {
		in.bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_equal(is_taken(&in, in.size, largest), bit / 8 >= 4 || bit == 8 * 3);
		in.bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
}

static void all_that_lies_before_a_fault_comes_out(void **state)
{
	(void)state;
	static buffer data, in;
	for (size_t size = 1000; size <= 200000; size *= 2) {
		fill(&data, size, size);
		in.size = 0;
		put_header(&in, 0, 0);
		put_deflated(&in, data.bytes, data.size, 6, Z_DEFAULT_STRATEGY, NULL, Z_SYNC_FLUSH);
		put_number(&in, 7, 1); /* the last block, of the fourth type, which does not exist */
		put_number(&in, 0, 4);
		assert_inflates(&in, &data, ESKEL_MALFORMED);
	}
}

static void nothing_refers_back_beyond_its_member(void **state)
{
	(void)state;
	static buffer data, in, both, before;
	fill(&data, 1000, 5);
	put_header(&in, 0, 0);
	put_deflated(&in, data.bytes, data.size, 9, Z_FIXED, &data, Z_FINISH);
	put_trailer(&in, data.bytes, data.size);
	before.size = 1; /* zlib begins with the first byte itself */
	before.bytes[0] = data.bytes[0];
	assert_inflates(&in, &before, ESKEL_MALFORMED);
	put_member(&both, 0, data.bytes, data.size);
	put(&both, in.bytes, in.size);
	put(&data, before.bytes, 1);
	assert_inflates(&both, &data, ESKEL_MALFORMED);
}

static void its_first_bytes_are_told_by_the_first_bytes_of_a_file(void **unused)
{
	(void)unused;
	static buffer b;
	uint8_t data[500], begin[300];
	b.size = 0;
	for (size_t i = 0; i < sizeof data; i++)
		data[i] = (uint8_t)(i * i >> 4);
	put_member(&b, name | extra, data, sizeof data);
	size_t told = 0;
	for (size_t size = 0; size <= b.size; size++) {
		memset(begin, 0xee, sizeof begin);
		const size_t most = size % 2 ? sizeof begin : 132, count = eskel_gzip_begin(b.bytes, size, begin, most);
		assert_in_range(count, told < most ? told : most, most);
		assert_memory_equal(begin, data, count);
		told = count;
	}
	assert_int_equal(eskel_gzip_begin(b.bytes, b.size, begin, sizeof begin), sizeof begin);
	assert_memory_equal(begin, data, sizeof begin);
	b.bytes[1] ^= 1;
	assert_int_equal(eskel_gzip_begin(b.bytes, b.size, begin, sizeof begin), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_combination_of_header_fields_is_read),
		cmocka_unit_test(every_kind_of_block_is_inflated),
		cmocka_unit_test(a_long_stretch_of_one_value_is_inflated),
		cmocka_unit_test(members_are_joined),
		cmocka_unit_test(a_stream_is_complete_at_the_end_of_a_member_alone),
		cmocka_unit_test(a_changed_byte_is_refused),
		cmocka_unit_test(without_a_checksum_the_header_may_say_any_time_and_system),
		cmocka_unit_test(all_that_lies_before_a_fault_comes_out),
		cmocka_unit_test(nothing_refers_back_beyond_its_member),
		cmocka_unit_test(its_first_bytes_are_told_by_the_first_bytes_of_a_file),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
