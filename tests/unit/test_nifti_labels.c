/* NIfTI files with header extensions: what their XML calls the labels 1 and 2. Each is decoded whole and in pieces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "nifti_file.h"
#include "volume_decode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As TotalSegmentator writes it. */
#define BEFORE \
	"<?xml version=\"1.0\" encoding=\"UTF-8\"?> <CaretExtension>  <Date><![CDATA[2013-07-14T05:45:09]]></Date>   " \
	"<VolumeInformation Index=\"0\">   <LabelTable>\n"
#define AFTER \
	"\n  </LabelTable>  <StudyMetaDataLinkSet>  </StudyMetaDataLinkSet>  " \
	"<VolumeType><![CDATA[Label]]></VolumeType>   " \
	"</VolumeInformation></CaretExtension>\n              "

#define LABEL(key, name) "<Label Key=\"" key "\" Red=\"1.0\" Green=\"0.5\" Blue=\"0\" Alpha=\"1\">" name "</Label>\n"
#define BROKEN_TABLE(broken) BEFORE LABEL("1", "liver") broken

enum { voxel_count = 8 };

typedef struct {
	uint32_t code;
	const char *content;
	size_t content_size; /* 0: of the text */
	uint32_t said_size;  /* 0: the right one */
} extension;

typedef struct {
	uint8_t *bytes;
	size_t size;
} file;

static void put32(uint8_t *b, bool big_endian, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		b[big_endian ? 3 - i : i] = (uint8_t)(value >> (8 * i));
}

static size_t padded_size(const extension *e)
{
	return (8 + (e->content_size ? e->content_size : strlen(e->content)) + 15) / 16 * 16;
}

static size_t sizes_of(const extension *extensions, size_t count)
{
	size_t size = 0;
	for (size_t i = 0; i < count; i++)
		size += padded_size(&extensions[i]);
	return size;
}

static file write_file(int version, bool big_endian, const extension *extensions, size_t count)
{
	static const double voxels[voxel_count] = {0, 1, 1, 2, 2, 2, 0, 1};
	nifti_file header = nifti_file_new(version, big_endian, 2, 2, 2, 2);
	size_t at = (size_t)header.vox_offset;
	header.vox_offset += (double)sizes_of(extensions, count);
	file f;
	f.bytes = nifti_file_write(&header, voxels, voxel_count, &f.size);
	f.bytes[at - 4] = 1;
	for (size_t i = 0; i < count; i++) {
		const extension *e = &extensions[i];
		const size_t size = padded_size(e);
		put32(f.bytes + at, big_endian, e->said_size ? e->said_size : (uint32_t)size);
		put32(f.bytes + at + 4, big_endian, e->code);
		memcpy(f.bytes + at + 8, e->content, e->content_size ? e->content_size : strlen(e->content));
		at += size;
	}
	return f;
}

static eskel_status decode(const file *f, size_t piece, eskel_volume **volume, eskel_error *error)
{
	return volume_decode(f->bytes, f->size, piece, NULL, volume, error);
}

static void assert_name(const eskel_volume *volume, int32_t label, const char *name)
{
	const char *got = eskel_volume_label_name(volume, label);
	if (!name != !got || (name && strcmp(name, got) != 0))
		fail_msg("label %d is called %s, expected %s", label, got ? got : "nothing", name ? name : "nothing");
}

/* warning: the sentence, NULL for none. */
static void assert_names_of(file f, const char *first, const char *second, const char *warning)
{
	const size_t pieces[] = {f.size, 7, 1};
	for (size_t p = 0; p < 3; p++) {
		eskel_volume *volume;
		eskel_error error = {0};
		if (decode(&f, pieces[p], &volume, &error) != ESKEL_OK)
			fail_msg("%s", error.text);
		assert_name(volume, 1, first);
		assert_name(volume, 2, second);
		const eskel_volume_info *info = eskel_volume_get_info(volume);
		assert_int_equal(info->warning_count, warning != NULL);
		if (warning) {
			assert_int_equal(info->warnings[0].code, ESKEL_WARNING_NAMES_INCOMPLETE);
			assert_string_equal(info->warnings[0].text, warning);
		}
		eskel_volume_free(volume);
	}
	free(f.bytes);
}

static void assert_names(const char *xml, const char *first, const char *second)
{
	const extension e = {.code = 0, .content = xml};
	assert_names_of(write_file(1, false, &e, 1), first, second, NULL);
}

static void the_names_of_TotalSegmentator_and_Workbench_are_read_in_every_version_and_byte_order(void **state)
{
	(void)state;
	static const char xml[] = BEFORE LABEL("1", "<![CDATA[spleen]]>") LABEL("2", "<![CDATA[kidney_right]]>") AFTER;
	for (int kind = 0; kind < 8; kind++) {
		const extension e = {.code = kind & 4 ? 30 : 0, .content = xml};
		assert_names_of(write_file(kind & 1 ? 2 : 1, kind & 2, &e, 1), "spleen", "kidney_right", NULL);
	}
}

static void text_is_read_as_XML_says(void **state)
{
	(void)state;
	static const struct {
		const char *xml, *name;
	} texts[] = {
		{LABEL("1", "liver"), "liver"},
		{"<Label Key='1'>liver</Label>", "liver"},
		{"<Label\n\tRed=\"1>2\" Key = \"1\"\n>liver</Label >", "liver"},
		{LABEL("1", "\n\t liver  left \n"), "liver  left"},
		{LABEL("1", "a&lt;b&gt; &amp;amp; &quot;c&apos;"), "a<b> &amp; \"c'"},
		{LABEL("1", "&#76;&#x65;&#xDF;er &#x20ac; &#x1f9b4; &#0955;"),
			"Le\xc3\x9f"
			"er \xe2\x82\xac \xf0\x9f\xa6\xb4 \xce\xbb"},
		{LABEL("1", "li<![CDATA[&lt;<v]]]>er<!-- no -->"), "li&lt;<v]er"},
		{LABEL("1", "tabs\tand\nlines"), "tabs and lines"},
		{"<!-- <Label Key=\"1\">no</Label> --><Other a=\"b\">x</Other>" LABEL("1", "liver"), "liver"},
		{LABEL("1", "first") LABEL("1", "second"), "first"},
		{LABEL("-1", "no") LABEL("0", "???") LABEL("2147483647", "no"), NULL},
		{"<Label Key=\"1\" Red=\"1\"/>", NULL},
		{LABEL("1", " \n "), NULL},
		{"<Labels Key=\"1\">no</Labels>", NULL},
		{"", NULL},
	};
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		char xml[2048];
		snprintf(xml, sizeof xml, "%s%s%s", BEFORE, texts[i].xml, AFTER);
		assert_names(xml, texts[i].name, NULL);
	}
}

static void a_name_is_cut_off_after_200_bytes_before_a_character(void **state)
{
	(void)state;
	char xml[2048], expected[201] = "";
	snprintf(xml, sizeof xml,
		"%s<Label Key=\"1\">  %0199d\xc3\xa9tude</Label><Label Key=\"2\">%0200d&#233;</Label>%s", BEFORE, 7, 8,
		AFTER);
	snprintf(expected, sizeof expected, "%0199d", 7);
	char second[201];
	snprintf(second, sizeof second, "%0200d", 8);
	assert_names(xml, expected, second);
}

static void only_the_first_table_of_an_extension_counts(void **state)
{
	(void)state;
	assert_names(BEFORE LABEL("1", "liver") "</LabelTable></VolumeInformation><VolumeInformation "
						"Index=\"1\"><LabelTable>" LABEL("1", "x") LABEL("2", "y") AFTER,
		"liver", NULL);
}

static void other_extensions_are_passed_over(void **state)
{
	(void)state;
	const extension extensions[] = {
		{.code = 2, .content = BEFORE LABEL("1", "Doe^Jane") AFTER},
		{.code = 6, .content = "a comment"},
		{.code = 0, .content = "<Other><LabelTable>" LABEL("1", "no") "</LabelTable></Other>"},
		{.code = 30, .content = BEFORE LABEL("2", "spleen") AFTER},
	};
	assert_names_of(write_file(1, false, extensions, 4), NULL, "spleen", NULL);
}

static void what_is_no_XML_ends_the_names_with_a_warning(void **state)
{
	(void)state;
	static const char *const broken[] = {"<Label Key=\"2\"", "<Label Key=\"2\">", "<Label Key=\"2\">spleen",
		"<Label Key=\"2\">spleen<", "<Label Key=\"2\" >a</", "<Label Key=\"2\">spleen</Label",
		LABEL("two", "x"), LABEL("", "x"), LABEL("2147483648", "x"), LABEL("99999999999", "x"),
		"<Label Red=\"1\">x</Label>", "<Label Key=2>x</Label>", "<Label Key \"2\">x</Label>",
		"<Label Key=\"2>x</Label>", "<Label =\"2\">x</Label>", LABEL("2", "<b>x</b>"), LABEL("2", "&nbsp;"),
		LABEL("2", "&#;"), LABEL("2", "&#x;"), LABEL("2", "&#0;"), LABEL("2", "&#xd800;"),
		LABEL("2", "&#x110000;"), LABEL("2", "&#99999999999;"), LABEL("2", "&#5a;"), LABEL("2", "&#65"),
		LABEL("2", "<![CDATA[x"), LABEL("2", "<!-- x"), "<!-- x", "<Other", "</LabelTabl", "no end"};
	for (size_t i = 0; i < sizeof broken / sizeof broken[0]; i++) {
		char xml[1024];
		snprintf(xml, sizeof xml, "%s%s", BROKEN_TABLE(""), broken[i]);
		const extension e = {.code = 0, .content = xml};
		assert_names_of(write_file(1, false, &e, 1), "liver", NULL,
			"the header extensions break off, are damaged or go on past 1048576 bytes; 1 label names were "
			"read");
	}
}

static void a_damaged_extension_ends_the_names_with_a_warning(void **state)
{
	(void)state;
	static const uint32_t sizes[] = {7, 200, 0x7fffffff, 0xfffffff0};
	for (size_t i = 0; i < 4; i++) {
		const extension extensions[] = {
			{.code = 0, .content = BEFORE LABEL("1", "liver") AFTER},
			{.code = 6, .content = "a comment", .said_size = sizes[i]},
		};
		assert_names_of(write_file(2, true, extensions, 2), "liver", NULL,
			"the header extensions break off, are damaged or go on past 1048576 bytes; 1 label names were "
			"read");
	}
}

static void padding_behind_the_extensions_is_no_damage(void **state)
{
	(void)state;
	static const char zeros[64];
	const extension extensions[] = {
		{.code = 0, .content = BEFORE LABEL("1", "liver") AFTER},
		{.code = 0, .content = zeros, .content_size = sizeof zeros, .said_size = 0},
	};
	file f = write_file(1, false, extensions, 2);
	memset(f.bytes + f.size - voxel_count - padded_size(&extensions[1]), 0, 8);
	assert_names_of(f, "liver", NULL, NULL);
}

static void extensions_are_not_read_without_their_flag(void **state)
{
	(void)state;
	const extension e = {.code = 0, .content = BEFORE LABEL("1", "liver") AFTER};
	file f = write_file(1, false, &e, 1);
	f.bytes[348] = 0;
	assert_names_of(f, NULL, NULL, NULL);
}

static void names_are_searched_in_the_first_MiB(void **state)
{
	(void)state;
	char *blanks = malloc(2 << 20);
	assert_non_null(blanks);
	memset(blanks, ' ', 2 << 20);
	const extension extensions[] = {
		{.code = 0, .content = BEFORE LABEL("1", "liver") AFTER},
		{.code = 6, .content = blanks, .content_size = 2 << 20},
		{.code = 0, .content = BEFORE LABEL("2", "spleen") AFTER},
	};
	assert_names_of(write_file(1, false, extensions, 3), "liver", NULL,
		"the header extensions break off, are damaged or go on past 1048576 bytes; 1 label names were read");
	free(blanks);
}

static void of_too_many_names_the_first_4096_are_kept(void **state)
{
	(void)state;
	enum { label_size = 48, count = 5000 };
	char *xml = malloc(sizeof BEFORE + count * label_size + sizeof AFTER), *end = stpcpy(xml, BEFORE);
	for (int i = count; i > 0; i--)
		end += sprintf(end, "<Label Key=\"%d\">label %d</Label>", i, i);
	strcpy(end, AFTER);
	const extension e = {.code = 0, .content = xml};
	assert_names_of(write_file(1, false, &e, 1), NULL, NULL,
		"the header extensions break off, are damaged or go on past 1048576 bytes; 4096 label names were read");
	free(xml);
}

static void a_file_that_ends_in_its_extensions_is_refused(void **state)
{
	(void)state;
	const extension e = {.code = 0, .content = BEFORE LABEL("1", "liver") AFTER};
	file f = write_file(1, false, &e, 1);
	f.size = 500;
	eskel_volume *volume;
	eskel_error error = {0};
	assert_int_equal(decode(&f, 3, &volume, &error), ESKEL_TRUNCATED);
	assert_string_equal(error.text, "the file ends after 500 bytes, within its header");
	free(f.bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_names_of_TotalSegmentator_and_Workbench_are_read_in_every_version_and_byte_order),
		cmocka_unit_test(text_is_read_as_XML_says),
		cmocka_unit_test(a_name_is_cut_off_after_200_bytes_before_a_character),
		cmocka_unit_test(only_the_first_table_of_an_extension_counts),
		cmocka_unit_test(other_extensions_are_passed_over),
		cmocka_unit_test(what_is_no_XML_ends_the_names_with_a_warning),
		cmocka_unit_test(a_damaged_extension_ends_the_names_with_a_warning),
		cmocka_unit_test(padding_behind_the_extensions_is_no_damage),
		cmocka_unit_test(extensions_are_not_read_without_their_flag),
		cmocka_unit_test(names_are_searched_in_the_first_MiB),
		cmocka_unit_test(of_too_many_names_the_first_4096_are_kept),
		cmocka_unit_test(a_file_that_ends_in_its_extensions_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
