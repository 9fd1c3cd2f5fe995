/* In what two matched shapes differ, see difference.h.
 *
 * A number is notable when it differs by more than a grid may be the cause of: about the 90th percentile of the changes
 * at level 10 when 17 bones are resampled at 2 mm (1.5 mm the small ones). */
#include "difference.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOTABLE_LENGTH 1.10     /* measured 1.11 to 1.17 */
#define NOTABLE_PROPORTION 1.15 /* 1.14 to 1.17 */
#define NOTABLE_SHARE 1.33      /* 1.39; as lengths, cubed */
#define NOTABLE_SOLIDITY 0.05   /* 0.049 */
/* Of the side of a cube of the object's volume. Three times the median; a class or two of each bone lies elsewhere. */
#define NOTABLE_RHO 0.05

/* At level 1, which does not depend on a partition. */
#define NOTABLE_WHOLE_LENGTH 1.02 /* 1.004 to 1.013 */
#define NOTABLE_VOLUME 1.03       /* 1.026 */

typedef struct {
	const char *more, *less;
} word_pair;

static const word_pair axis_words[3] = {{"longer", "shorter"}, {"wider", "narrower"}, {"thicker", "thinner"}};

/* Parts with commas between, in an array of fixed size that begins with other text. */
typedef struct {
	char *text;
	size_t size, parts;
} sentence;

/* What does not fit is cut off. */
__attribute__((format(printf, 2, 3))) static void add(sentence *s, const char *format, ...)
{
	if (s->parts++ > 0)
		strncat(s->text, ", ", s->size - strlen(s->text) - 1);
	const size_t used = strlen(s->text);
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(s->text + used, s->size - used, format, arguments);
	va_end(arguments);
}

/* A ratio in multiples of a notable one; 0 where it is not a number. */
static double of_ratio(double ratio, double notable)
{
	return ratio > 0 && isfinite(ratio) ? fabs(log(ratio)) / log(notable) : 0;
}

static bool add_ratio(sentence *s, double ratio, double notable, word_pair words)
{
	if (of_ratio(ratio, notable) < 1)
		return false;
	add(s, "%.0f %% %s", 100 * fabs(ratio - 1), ratio > 1 ? words.more : words.less);
	return true;
}

static bool add_lengths(sentence *s, const double ratio[3], double notable)
{
	bool any = false;
	for (int axis = 0; axis < 3; axis++)
		any = add_ratio(s, ratio[axis], notable, axis_words[axis]) || any;
	return any;
}

/* Proportions follow from the axes, and are worth a word only where those are not. */
static void write_text(esk_difference *d, double size)
{
	sentence s = {d->text, sizeof d->text, 0};
	snprintf(d->text, sizeof d->text, "class %u: ", d->class_index);
	if (!add_lengths(&s, d->length_ratio, NOTABLE_LENGTH)) {
		add_ratio(&s, d->elongation_ratio, NOTABLE_PROPORTION, (word_pair){"more elongated", "less elongated"});
		add_ratio(&s, d->flatness_ratio, NOTABLE_PROPORTION, (word_pair){"flatter", "less flat"});
	}
	add_ratio(&s, d->share_ratio, NOTABLE_SHARE, (word_pair){"more of the volume", "less of the volume"});
	if (fabs(d->solidity_difference) >= NOTABLE_SOLIDITY)
		add(&s, "%s solid", d->solidity_difference > 0 ? "more" : "less");
	if (fabs(d->rho_difference) >= NOTABLE_RHO * size)
		add(&s, "%.1f mm %s", fabs(d->rho_difference),
			d->rho_difference > 0 ? "farther out" : "nearer the centre");
	if (s.parts == 0)
		d->text[0] = 0;
}

static double importance(const esk_difference *d, double size)
{
	double most =
		fmax(fabs(d->solidity_difference) / NOTABLE_SOLIDITY, fabs(d->rho_difference) / (NOTABLE_RHO * size));
	for (int axis = 0; axis < 3; axis++)
		most = fmax(most, of_ratio(d->length_ratio[axis], NOTABLE_LENGTH));
	most = fmax(most, of_ratio(d->elongation_ratio, NOTABLE_PROPORTION));
	most = fmax(most, of_ratio(d->flatness_ratio, NOTABLE_PROPORTION));
	return fmax(most, of_ratio(d->share_ratio, NOTABLE_SHARE));
}

static double share(const eskel_skeleton *skeleton, uint32_t level, uint32_t class_index)
{
	return eskel_skeleton_node(skeleton, level, class_index)->weight / skeleton->weight;
}

static double quotient(double a, double b)
{
	return b > 0 ? a / b : NAN;
}

/* What lengths of the neighbour are multiplied by. */
static double scale_of(const esk_compared *query, const esk_compared *neighbour, eskel_size size)
{
	return size == ESKEL_SIZE_FREE ? cbrt(query->signature->volume / neighbour->signature->volume) : 1;
}

static esk_difference difference_of(
	const esk_compared *query, const esk_compared *neighbour, const eskel_match *match, double scale, uint32_t i)
{
	const uint32_t level = match->level, j = match->other[i];
	const double *row = query->signature->rows[ESKEL_NODES(level - 1) + i];
	const double *other = neighbour->signature->rows[ESKEL_NODES(level - 1) + j];
	esk_difference d = {.class_index = i, .other = j};
	for (int axis = 0; axis < 3; axis++)
		d.length_ratio[axis] = quotient(row[axis], other[axis] * scale);
	d.elongation_ratio = quotient(quotient(row[0], row[1]), quotient(other[0], other[1]));
	d.flatness_ratio = quotient(quotient(row[1], row[2]), quotient(other[1], other[2]));
	d.share_ratio = quotient(share(query->skeleton, level, i), share(neighbour->skeleton, level, j));
	d.solidity_difference = row[4] - other[4];
	d.rho_difference = row[3] - other[3] * scale;
	d.importance = importance(&d, cbrt(query->signature->volume));
	write_text(&d, cbrt(query->signature->volume));
	return d;
}

static int by_importance(const void *a, const void *b)
{
	const esk_difference *p = a, *q = b;
	return p->importance != q->importance ? (p->importance < q->importance) - (p->importance > q->importance)
					      : (p->class_index > q->class_index) - (p->class_index < q->class_index);
}

void esk_differences_of_classes(const esk_compared *query, const esk_compared *neighbour, const eskel_match *match,
	eskel_size size, esk_difference *differences)
{
	const uint32_t count = match->level;
	const double scale = scale_of(query, neighbour, size);
	for (uint32_t i = 0; i < count; i++)
		differences[i] = difference_of(query, neighbour, match, scale, i);
	qsort(differences, count, sizeof *differences, by_importance);
	const double median = count > 1 ? differences[count / 2].importance : 0;
	for (uint32_t i = 0; i < count; i++)
		differences[i].remarkable = differences[i].importance >= fmax(1, 2 * median);
}

/* "; classes 3, 7 stand out" */
static void add_remarkable(char *text, size_t size, const esk_difference *differences, uint32_t count)
{
	uint32_t remarkable = 0;
	while (remarkable < count && differences[remarkable].remarkable)
		remarkable++;
	if (remarkable == 0)
		return;
	strncat(text, remarkable > 1 ? "; classes " : "; class ", size - strlen(text) - 1);
	sentence s = {text, size, 0};
	for (uint32_t i = 0; i < remarkable; i++)
		add(&s, "%u", differences[i].class_index);
	strncat(text, remarkable > 1 ? " stand out" : " stands out", size - strlen(text) - 1);
}

void esk_difference_of_wholes(const esk_compared *query, const esk_compared *neighbour, eskel_size size,
	const esk_difference *differences, uint32_t count, esk_whole_difference *whole)
{
	const double scale = scale_of(query, neighbour, size);
	esk_whole_difference w = {.volume_ratio = query->signature->volume / neighbour->signature->volume};
	sentence s = {w.text, sizeof w.text, 0};
	for (int axis = 0; axis < 3; axis++)
		w.length_ratio[axis] =
			quotient(query->signature->rows[0][axis], neighbour->signature->rows[0][axis] * scale);
	if (!add_ratio(&s, w.volume_ratio, NOTABLE_VOLUME, (word_pair){"larger", "smaller"}))
		add(&s, "of the same size");
	add_lengths(&s, w.length_ratio, NOTABLE_WHOLE_LENGTH);
	add_remarkable(w.text, sizeof w.text, differences, count);
	*whole = w;
}
