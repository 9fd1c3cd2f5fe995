/* Threads that run loops together. */
#ifndef ESK_TEAM_H
#define ESK_TEAM_H

#include <stddef.h>
#include <stdint.h>

/* NULL is a team of the caller alone. */
typedef struct esk_team esk_team;

/* The number that options mean: 1 for 0, that of the processors for ESKEL_THREADS_ONLINE, and never very many. */
uint32_t esk_team_threads(uint32_t asked);

/* The caller and threads - 1 more, or as many of them as can be started. */
esk_team *esk_team_new(uint32_t threads);
void esk_team_free(esk_team *team);
uint32_t esk_team_size(const esk_team *team);

/* Runs task(context, index) once for every index below count, in any order, and returns when all have ended. The caller
 * takes part; one loop at a time, and no task runs another on the same team. */
void esk_team_run(esk_team *team, size_t count, void (*task)(void *context, size_t index), void *context);

#endif
