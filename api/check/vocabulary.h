/* The classes of the library, by name and by what names have in common, each with its statistics once somebody needs them. */
#ifndef ESK_VOCABULARY_H
#define ESK_VOCABULARY_H

#include "class_statistics.h"
#include "exchange.h"
#include "label_name.h"

/* All zero before esk_vocabulary_open. */
typedef struct {
	size_t count;
	char **names;
	char (*keys)[ESK_LABEL_KEY_SIZE]; /* "": none */
	esk_class_statistics *statistics;
	bool *counted; /* whether the statistics are made */
} esk_vocabulary;

/* Close it also after a failure. */
bool esk_vocabulary_open(esk_vocabulary *vocabulary, eskel_exchange *exchange);
void esk_vocabulary_close(esk_vocabulary *vocabulary);

/* The class of that name, or else one that differs by its vocabulary alone; SIZE_MAX for none and for NULL. */
size_t esk_vocabulary_find(const esk_vocabulary *vocabulary, const char *class);

/* Makes the statistics of a class, by the exchange's query. */
bool esk_vocabulary_count(esk_vocabulary *vocabulary, eskel_exchange *exchange, size_t index);

#endif
