"""What a peer measures of itself: as tests/bench/measure.h."""
import resource
import time


def least_milliseconds(run):
    """The fastest of five runs, or of as many as begin within a second."""
    least = float("inf")
    begin = time.perf_counter()
    for i in range(5):
        if i and time.perf_counter() - begin > 1:
            break
        start = time.perf_counter()
        run()
        least = min(least, time.perf_counter() - start)
    return 1e3 * least


def peak_megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def show(figure, program, value, unit):
    print(figure, program, f"{value:.6g}", unit, sep="\t", flush=True)
