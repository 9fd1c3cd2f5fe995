/* Texts and numbers as DICOM values have them (PS3.5, section 6.2). */
#ifndef ESK_DICOM_TEXT_H
#define ESK_DICOM_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The text without the blanks around it, in UTF-8 when the character set is that, Latin-1 or ASCII, else as it is;
 * cut to what fits, before a character. */
void esk_dicom_text(const uint8_t *bytes, size_t size, const char *character_set, char *text, size_t room);

/* Count decimal strings between backslashes, all finite; false, with numbers untouched, for anything else. */
bool esk_dicom_decimals(const uint8_t *bytes, size_t size, double *numbers, size_t count);

#endif
