#include "textbook_assignment.h"

#include <float.h>
#include <stdbool.h>

enum { MOST = 64 };

/* Rows and columns count from 1; row_of[0] is the row to be placed, column 0 is where its path begins. */
double textbook_assignment(int k, const float *costs)
{
	double u[MOST + 1] = {0}, v[MOST + 1] = {0};
	int row_of[MOST + 1] = {0}, previous[MOST + 1];
	for (int row = 1; row <= k; row++) {
		double least[MOST + 1];
		bool done[MOST + 1] = {false};
		for (int j = 0; j <= k; j++)
			least[j] = DBL_MAX;
		row_of[0] = row;
		int column = 0;
		do {
			const int i = row_of[column];
			int nearest = 0;
			double step = DBL_MAX;
			done[column] = true;
			for (int j = 1; j <= k; j++) {
				if (done[j])
					continue;
				const double reduced = (double)costs[(i - 1) * k + j - 1] - u[i] - v[j];
				if (reduced < least[j]) {
					least[j] = reduced;
					previous[j] = column;
				}
				if (least[j] < step) {
					step = least[j];
					nearest = j;
				}
			}
			for (int j = 0; j <= k; j++)
				if (done[j]) {
					u[row_of[j]] += step;
					v[j] -= step;
				} else {
					least[j] -= step;
				}
			column = nearest;
		} while (row_of[column] != 0);
		for (; column != 0; column = previous[column])
			row_of[column] = row_of[previous[column]];
	}
	double sum = 0;
	for (int j = 1; j <= k; j++)
		sum += (double)costs[(row_of[j] - 1) * k + j - 1];
	return sum;
}
