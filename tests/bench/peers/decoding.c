/* Peers of the volume decoder: decoding zlib|isal|nifti FIGURE FILE
 *
 * zlib, isal: the library's stream alone, 64 KB of the file at a time, into a buffer that is thrown away: the least that
 * the library allows.
 * nifti: libnifti's nifti_image_read of the whole grid. */
#include "../measure.h"

#include <isa-l/igzip_lib.h>
#include <nifti1_io.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static void inflate_by_zlib(void *path)
{
	static unsigned char in[65536], out[65536];
	z_stream z = {0};
	FILE *file = fopen(path, "rb");
	if (!file || inflateInit2(&z, 15 + 16) != Z_OK)
		exit(1);
	int status = Z_OK;
	while (status != Z_STREAM_END) {
		z.next_in = in;
		z.avail_in = (uInt)fread(in, 1, sizeof in, file);
		if (z.avail_in == 0)
			exit(1);
		do {
			z.next_out = out;
			z.avail_out = sizeof out;
			status = inflate(&z, Z_NO_FLUSH);
		} while (status == Z_OK && z.avail_out == 0);
	}
	inflateEnd(&z);
	fclose(file);
}

static void inflate_by_isal(void *path)
{
	static unsigned char in[65536], out[262144];
	static struct inflate_state state;
	FILE *file = fopen(path, "rb");
	if (!file)
		exit(1);
	isal_inflate_init(&state);
	state.crc_flag = ISAL_GZIP;
	while (state.block_state != ISAL_BLOCK_FINISH) {
		state.next_in = in;
		state.avail_in = (uint32_t)fread(in, 1, sizeof in, file);
		if (state.avail_in == 0)
			exit(1);
		do {
			state.next_out = out;
			state.avail_out = sizeof out;
			if (isal_inflate(&state) != ISAL_DECOMP_OK)
				exit(1);
		} while (state.avail_out == 0);
	}
	fclose(file);
}

static void read_image(void *path)
{
	nifti_image *image = nifti_image_read(path, 1);
	if (!image)
		exit(1);
	nifti_image_free(image);
}

static const struct {
	const char *name, *program;
	void (*run)(void *path);
} peers[] = {
	{"zlib", "zlib inflate alone", inflate_by_zlib},
	{"isal", "ISA-L inflate alone", inflate_by_isal},
	{"nifti", "libnifti to an array", read_image},
};

int main(int argc, char **argv)
{
	if (argc != 4)
		return 2;
	for (size_t i = 0; i < sizeof peers / sizeof peers[0]; i++)
		if (!strcmp(argv[1], peers[i].name)) {
			measure_print(argv[2], peers[i].program, measure_least(peers[i].run, argv[3]), "ms");
			measure_print(argv[2], peers[i].program, measure_peak_megabytes(), "MB");
			return 0;
		}
	return 2;
}
