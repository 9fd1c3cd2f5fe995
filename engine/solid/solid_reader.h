/* The push decoder of mesh files: STL (binary and ASCII), PLY (all three encodings) and OBJ. */
#ifndef ESK_SOLID_READER_H
#define ESK_SOLID_READER_H

#include "solid.h"

typedef enum { ESK_SPACE_UNSAID, ESK_SPACE_RAS, ESK_SPACE_LPS } esk_solid_space;

typedef struct esk_solid_reader esk_solid_reader;

/* Whether a mesh can begin so: with text, or with the zeros that some leave as the header of a binary STL. */
bool esk_solid_may_begin(const uint8_t bytes[4]);

eskel_status esk_solid_reader_new(esk_solid_reader **reader);
void esk_solid_reader_free(esk_solid_reader *reader);

/* The file's next bytes, from the first one on. ESKEL_NOT_VOLUME, without a sentence, when it is no mesh. After a failure
 * no more calls. */
eskel_status esk_solid_reader_feed(esk_solid_reader *reader, const uint8_t *bytes, size_t size, eskel_error *error);
/* The file ends here. The mesh is closed, in RAS, and owned by the reader. */
eskel_status esk_solid_reader_finish(esk_solid_reader *reader, const esk_solid **solid, eskel_error *error);

/* "STL", "PLY" or "OBJ", static. */
const char *esk_solid_reader_format(const esk_solid_reader *reader);
esk_solid_space esk_solid_reader_space(const esk_solid_reader *reader);

#endif
