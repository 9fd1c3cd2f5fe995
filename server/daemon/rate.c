#include "rate.h"

#include <pthread.h>
#include <stdlib.h>

enum { SETS = 512, WAYS = 8 };

typedef struct {
	uint64_t key;
	double level; /* requests left */
	int64_t at;   /* when level was right; 0: never used */
} bucket;

struct esk_rate {
	double a_second;
	pthread_mutex_t lock;
	bucket buckets[SETS][WAYS];
};

esk_rate *esk_rate_new(uint64_t a_second)
{
	esk_rate *rate = calloc(1, sizeof *rate);
	if (!rate)
		return NULL;
	rate->a_second = (double)a_second;
	pthread_mutex_init(&rate->lock, NULL);
	return rate;
}

void esk_rate_free(esk_rate *rate)
{
	if (!rate)
		return;
	pthread_mutex_destroy(&rate->lock);
	free(rate);
}

/* The finalizer of splitmix64: addresses of one network spread over all sets. */
static uint64_t mix(uint64_t key)
{
	key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9u;
	key = (key ^ key >> 27) * 0x94d049bb133111ebu;
	return key ^ key >> 31;
}

static bucket *find(esk_rate *rate, uint64_t key, int64_t now)
{
	bucket *set = rate->buckets[mix(key) % SETS], *oldest = set;
	for (int w = 0; w < WAYS; w++) {
		if (set[w].at && set[w].key == key)
			return &set[w];
		if (set[w].at < oldest->at)
			oldest = &set[w];
	}
	*oldest = (bucket){key, rate->a_second, now};
	return oldest;
}

bool esk_rate_take(esk_rate *rate, uint64_t key, double cost, int64_t now)
{
	pthread_mutex_lock(&rate->lock);
	bucket *b = find(rate, key, now);
	if (now > b->at) {
		b->level += (double)(now - b->at) * rate->a_second / 1000;
		b->at = now;
	}
	if (b->level > rate->a_second)
		b->level = rate->a_second;
	bool enough = b->level >= 1;
	if (enough)
		b->level -= cost; /* below zero after a dear request: the next ones wait for it */
	pthread_mutex_unlock(&rate->lock);
	return enough;
}
