/* In what two matched classes differ, see difference.h. */
#include "difference.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Twice the median change of a signature at level 10 when its object is resampled at 2 mm (4.7 %): less than this may
 * be the grid's doing. rho is measured against the side of a cube of the object's volume. */
#define NOTABLE_RATIO 1.10
#define NOTABLE_RHO 0.05

static const struct {
	const char *more, *less;
} axis_words[3] = {{"longer", "shorter"}, {"wider", "narrower"}, {"thicker", "thinner"}};

__attribute__((format(printf, 2, 3))) static void add(esk_difference *difference, const char *format, ...)
{
	char *text = difference->text;
	size_t used = strlen(text);
	if (used == 0)
		used = (size_t)snprintf(text, sizeof difference->text, "class %u: ", difference->class_index);
	else
		used += (size_t)snprintf(text + used, sizeof difference->text - used, ", ");
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text + used, sizeof difference->text - used, format, arguments);
	va_end(arguments);
}

static void write_text(esk_difference *difference, double volume)
{
	for (unsigned axis = 0; axis < 3; axis++) {
		double ratio = difference->length_ratio[axis];
		if (ratio >= NOTABLE_RATIO)
			add(difference, "%.0f %% %s", 100 * (ratio - 1), axis_words[axis].more);
		else if (ratio <= 1 / NOTABLE_RATIO)
			add(difference, "%.0f %% %s", 100 * (1 - ratio), axis_words[axis].less);
	}
	double rho = difference->rho_difference;
	if (fabs(rho) >= NOTABLE_RHO * cbrt(volume))
		add(difference, "%.1f mm %s", fabs(rho), rho > 0 ? "farther out" : "nearer the centre");
}

void esk_difference_of_class(const eskel_signature *query, const eskel_signature *neighbour, const eskel_match *match,
	eskel_size size, uint32_t i, esk_difference *difference)
{
	size_t first = ESKEL_NODES(match->level - 1);
	const double *row = query->rows[first + i], *other = neighbour->rows[first + match->other[i]];
	double scale = size == ESKEL_SIZE_FREE ? cbrt(query->volume / neighbour->volume) : 1;
	*difference = (esk_difference){.class_index = i, .other = match->other[i]};
	for (unsigned axis = 0; axis < 3; axis++)
		difference->length_ratio[axis] = other[axis] > 0 ? row[axis] / (other[axis] * scale) : NAN;
	difference->rho_difference = row[3] - other[3] * scale;
	write_text(difference, query->volume);
}
