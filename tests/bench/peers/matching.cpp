// LEMON's network simplex on the matrices of costs of files: matching FILE...
#include "../measure.h"

#include <cstdlib>
#include <cstring>
#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>
#include <vector>

using lemon::SmartDigraph;

static std::vector<float> read_floats(const char *path)
{
	std::vector<float> all;
	float piece[4096];
	FILE *file = fopen(path, "rb");
	if (!file)
		exit(1);
	for (size_t n; (n = fread(piece, sizeof *piece, 4096, file)) > 0;)
		all.insert(all.end(), piece, piece + n);
	fclose(file);
	return all;
}

static void match(const char *path)
{
	const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path, *dash = strchr(name, '-');
	const int k = atoi(dash + 1);
	const std::vector<float> costs = read_floats(path);
	SmartDigraph graph;
	SmartDigraph::ArcMap<double> cost(graph);
	SmartDigraph::NodeMap<int> supply(graph);
	std::vector<SmartDigraph::Arc> arcs;
	for (int i = 0; i < 2 * k; i++)
		supply[graph.addNode()] = i < k ? 1 : -1;
	for (int i = 0; i < k; i++)
		for (int j = 0; j < k; j++)
			arcs.push_back(graph.addArc(graph.nodeFromId(i), graph.nodeFromId(k + j)));
	lemon::NetworkSimplex<SmartDigraph, int, double> simplex(graph);
	simplex.supplyMap(supply);

	size_t done = 0;
	const double start = measure_milliseconds();
	while (measure_milliseconds() - start < 200)
		for (size_t at = 0; at < costs.size(); at += arcs.size(), done++) {
			for (size_t a = 0; a < arcs.size(); a++)
				cost[arcs[a]] = costs[at + a];
			simplex.costMap(cost);
			if (simplex.run() != simplex.OPTIMAL)
				exit(1);
		}
	char figure[64];
	snprintf(figure, sizeof figure, "match-%.*s/k=%d", static_cast<int>(dash - name), name, k);
	measure_print(figure, "LEMON NetworkSimplex",
		1e3 * (measure_milliseconds() - start) / static_cast<double>(done), "us");
	measure_print(figure, "LEMON NetworkSimplex", measure_peak_megabytes(), "MB");
}

int main(int argc, char **argv)
{
	for (int i = 1; i < argc; i++)
		match(argv[i]);
}
