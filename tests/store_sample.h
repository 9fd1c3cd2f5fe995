/* Small shapes to store, another one for every number, and a folder to store them in. For tests of the store; whatever
 * fails here ends the program. */
#ifndef STORE_SAMPLE_H
#define STORE_SAMPLE_H

#include "eskel_store.h"

typedef struct {
	eskel_cloud *cloud;
	eskel_skeleton *skeleton;
	eskel_signature *signature;
	eskel_description description; /* nothing recorded; fill it with strings that outlive the sample */
} sample;

/* Three levels; no two numbers below 2^20 have the same cloud. */
sample sample_new(uint32_t number);
void sample_free(sample *s);

/* Refers to the sample; its label is the number. */
eskel_enrollment sample_enrollment(const sample *s, int32_t label);

/* Enrolls sample number without anything recorded. shape may be NULL. */
eskel_store_status sample_enroll(eskel_store *store, uint32_t number, eskel_shape *shape, eskel_store_error *error);

/* A new folder under TMPDIR or /tmp; scratch_free removes it with all in it. */
char *scratch_new(void);
void scratch_free(char *folder);
/* folder/name, free() it. */
char *scratch_path(const char *folder, const char *name);

/* The whole file, free() it. */
uint8_t *file_read(const char *path, size_t *size);
void file_write(const char *path, const void *bytes, size_t size);

#endif
