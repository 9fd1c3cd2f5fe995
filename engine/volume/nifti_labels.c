/* Label names in the header extensions of NIfTI files, as Connectome Workbench (code 30) and TotalSegmentator (code 0) write
 * them:
 *
 *   <CaretExtension> ... <VolumeInformation Index="0"> <LabelTable>
 *     <Label Key="5" Red="1" Green="0" Blue="0" Alpha="1"><![CDATA[liver]]></Label> ...
 *
 * An extension is its size, a multiple of 16, its code, and its content. Of the XML only the first LabelTable is read, which is
 * that of the first volume. Nothing but names is kept, nothing is declared or included, and a reference stands for one
 * character, so what comes out is never longer than what went in. Extensions of other codes, which may hold patient data, are
 * passed over unread.
 */
#include "nifti_labels.h"

#include "byte_order.h"

#include <string.h>

enum { flag_size = 4, head_size = 8, code_any = 0, code_caret = 30 };

/* Bytes of a name as it is read, more than is kept of it. */
enum { name_room = ESK_SEGMENTS_LONGEST_NAME + 8 };

typedef struct {
	const char *at, *end;
} text;

typedef struct {
	char bytes[name_room];
	size_t size;
} name;

static bool starts_with(const text *t, const char *word)
{
	size_t size = strlen(word);
	return (size_t)(t->end - t->at) >= size && memcmp(t->at, word, size) == 0;
}

static bool take(text *t, const char *word)
{
	if (!starts_with(t, word))
		return false;
	t->at += strlen(word);
	return true;
}

/* Moves to the word; false, and nowhere, when it does not come. */
static bool find(text *t, const char *word)
{
	const char *found = memmem(t->at, (size_t)(t->end - t->at), word, strlen(word));
	if (found)
		t->at = found;
	return found;
}

static bool find_and_take(text *t, const char *word)
{
	return find(t, word) && take(t, word);
}

static bool is_blank(char c)
{
	return c == ' ' || (c >= '\t' && c <= '\r');
}

/* Whether there were any. */
static bool take_blanks(text *t)
{
	const char *first = t->at;
	while (t->at < t->end && is_blank(*t->at))
		t->at++;
	return t->at > first;
}

/* ---- names */

/* What has no room is not kept of a name anyway; nor are blanks at its start. */
static void append(name *n, const char *bytes, size_t size)
{
	for (size_t i = 0; i < size && n->size < name_room; i++)
		if (n->size > 0 || !is_blank(bytes[i]))
			n->bytes[n->size++] = bytes[i];
}

static void append_character(name *n, uint32_t c)
{
	char utf8[4];
	if (c < 0x80) {
		utf8[0] = (char)c;
		append(n, utf8, 1);
		return;
	}
	const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
	for (int i = more; i > 0; i--, c >>= 6)
		utf8[i] = (char)(0x80 | (c & 0x3f));
	utf8[0] = (char)(0xff00u >> (more + 1) | c); /* in its low byte, as many ones as bytes: c0, e0, f0 */
	append(n, utf8, (size_t)more + 1);
}

/* The number of &#38; or &#x26; behind its &#. */
static bool take_character_number(text *t, uint32_t *number)
{
	static const char digits[] = "0123456789abcdef";
	const uint32_t base = take(t, "x") ? 16 : 10;
	const char *first = t->at;
	uint32_t n = 0;
	for (; t->at < t->end && *t->at && n <= 0x10ffff; t->at++) {
		const char lower = *t->at >= 'A' && *t->at <= 'F' ? (char)(*t->at - 'A' + 'a') : *t->at;
		const char *digit = memchr(digits, lower, base);
		if (!digit)
			break;
		n = n * base + (uint32_t)(digit - digits);
	}
	*number = n;
	return t->at > first && take(t, ";") && n > 0 && n <= 0x10ffff && !(n >= 0xd800 && n <= 0xdfff);
}

static bool take_reference(text *t, name *n)
{
	static const struct {
		const char *reference, *character;
	} references[] = {{"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}};
	uint32_t number;
	for (size_t i = 0; i < sizeof references / sizeof references[0]; i++)
		if (take(t, references[i].reference)) {
			append(n, references[i].character, 1);
			return true;
		}
	if (!take(t, "&#") || !take_character_number(t, &number))
		return false;
	append_character(n, number);
	return true;
}

/* The text of an element without others in it, and the end of the element. */
static bool take_content(text *t, name *n)
{
	for (;;) {
		const char *first = t->at;
		if (take(t, "</"))
			return find_and_take(t, ">");
		if (take(t, "<![CDATA[")) {
			first = t->at;
			if (!find(t, "]]>"))
				return false;
			append(n, first, (size_t)(t->at - first));
			take(t, "]]>");
		} else if (take(t, "<!--")) {
			if (!find_and_take(t, "-->"))
				return false;
		} else if (starts_with(t, "&")) {
			if (!take_reference(t, n))
				return false;
		} else {
			if (t->at == t->end || *t->at == '<')
				return false;
			append(n, t->at++, 1);
		}
	}
}

/* ---- labels */

static bool parse_label(text value, int32_t *label)
{
	const bool negative = take(&value, "-");
	int64_t number = 0;
	if (value.at == value.end || value.end - value.at > 10)
		return false;
	for (; value.at < value.end; value.at++) {
		if (*value.at < '0' || *value.at > '9')
			return false;
		number = number * 10 + (*value.at - '0');
	}
	*label = (int32_t)(negative ? -number : number);
	return number <= INT32_MAX;
}

/* key = "value" or 'value' */
static bool take_attribute(text *t, text *key, text *value)
{
	key->at = t->at;
	while (t->at < t->end && !is_blank(*t->at) && !memchr("=<>/\"'", *t->at, 6))
		t->at++;
	key->end = t->at;
	take_blanks(t);
	if (key->at == key->end || !take(t, "="))
		return false;
	take_blanks(t);
	const char *quote = starts_with(t, "'") ? "'" : "\"";
	if (!take(t, quote))
		return false;
	value->at = t->at;
	if (!find(t, quote))
		return false;
	value->end = t->at;
	return take(t, quote);
}

/* From behind <Label to behind the start tag; is_empty when it ends the element too. */
static bool take_attributes(text *t, int32_t *label, bool *is_empty)
{
	bool has_key = false;
	text key, value;
	while (take_blanks(t), !starts_with(t, ">") && !starts_with(t, "/>")) {
		if (!take_attribute(t, &key, &value))
			return false;
		if (key.end - key.at == 3 && memcmp(key.at, "Key", 3) == 0) {
			if (!parse_label(value, label))
				return false;
			has_key = true;
		}
	}
	*is_empty = take(t, "/>");
	return has_key && (*is_empty || take(t, ">"));
}

static eskel_status take_label(text *t, esk_segments *segments)
{
	int32_t label;
	bool is_empty;
	name n = {.size = 0};
	if (!take_attributes(t, &label, &is_empty) || !(is_empty || take_content(t, &n)))
		return ESKEL_MALFORMED;
	return esk_segments_add_name(segments, label, n.bytes, n.size);
}

static eskel_status read_table(text t, esk_segments *segments)
{
	eskel_status status = ESKEL_OK;
	while (status == ESKEL_OK) {
		if (!find(&t, "<"))
			return ESKEL_MALFORMED;
		if (starts_with(&t, "</LabelTable"))
			return ESKEL_OK;
		if (take(&t, "<Label") && (take_blanks(&t) || starts_with(&t, ">") || starts_with(&t, "/>")))
			status = take_label(&t, segments);
		else if (!find_and_take(&t, take(&t, "<!--") ? "-->" : ">"))
			return ESKEL_MALFORMED;
	}
	return status;
}

/* ---- extensions */

static eskel_status read_content(text t, esk_segments *segments)
{
	if (!find_and_take(&t, "<CaretExtension") || !find_and_take(&t, "<LabelTable"))
		return ESKEL_OK;
	return find_and_take(&t, ">") ? read_table(t, segments) : ESKEL_MALFORMED;
}

eskel_status esk_nifti_labels_read(const uint8_t *bytes, size_t size, bool big_endian, esk_segments *segments)
{
	eskel_status status = ESKEL_OK;
	size_t at = flag_size;
	if (size < flag_size || bytes[0] == 0)
		return ESKEL_OK;
	while (status == ESKEL_OK && size - at >= head_size) {
		const uint64_t whole = esk_byte_order_unsigned(bytes + at, 4, big_endian), left = size - at;
		const uint64_t code = esk_byte_order_unsigned(bytes + at + 4, 4, big_endian);
		const text content = {
			(const char *)bytes + at + head_size, (const char *)bytes + at + (whole < left ? whole : left)};
		if (whole == 0) /* the rest is padding */
			return ESKEL_OK;
		if (whole < head_size)
			return ESKEL_MALFORMED;
		if (code == code_any || code == code_caret)
			status = read_content(content, segments);
		if (status == ESKEL_OK && whole > left)
			status = ESKEL_MALFORMED;
		at += (size_t)(whole < left ? whole : left);
	}
	return status;
}
