/* Two peers of the volume decoder: decoding inflate|nifti FIGURE FILE
 *
 * inflate: zlib's stream alone, 64 KB at a time, into a buffer that is thrown away: the least that zlib allows.
 * nifti: libnifti's nifti_image_read of the whole grid. */
#include "../measure.h"

#include <nifti1_io.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static void inflate_file(void *path)
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

static void read_image(void *path)
{
	nifti_image *image = nifti_image_read(path, 1);
	if (!image)
		exit(1);
	nifti_image_free(image);
}

int main(int argc, char **argv)
{
	if (argc != 4)
		return 2;
	const int inflating = !strcmp(argv[1], "inflate");
	const char *program = inflating ? "zlib inflate alone" : "libnifti to an array";
	measure_print(argv[2], program, measure_least(inflating ? inflate_file : read_image, argv[3]), "ms");
	measure_print(argv[2], program, measure_peak_megabytes(), "MB");
	return 0;
}
