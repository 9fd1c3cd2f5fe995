/* The shortest augmenting path method as textbooks have it: the peer of engine/assignment.c. */
#ifndef TEXTBOOK_ASSIGNMENT_H
#define TEXTBOOK_ASSIGNMENT_H

/* The least cost of giving each of k <= 64 rows its own column; costs[i * k + j]. O(k^3). */
double textbook_assignment(int k, const float *costs);

#endif
