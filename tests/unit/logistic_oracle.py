#!/usr/bin/python3
"""Holds the weights that print_logistic fits against those that scipy.optimize finds: logistic_oracle.py print_logistic

The program reads "prior w0 w1 w2 s0 s1 s2" and then one example a line, "right x0 x1 x2", and prints the weights."""
import subprocess
import sys

try:
    import numpy as np
    from scipy.optimize import minimize
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)


def loss(weights, features, right, prior, spreads):
    x = np.where(right, 1, -1) * (features @ weights)
    return np.logaddexp(0, -x).sum() + (((weights - prior) / spreads) ** 2).sum() / 2


random = np.random.default_rng(11)
worst = 0
for case in range(40):
    count = [0, 1, 5, 40, 400][case % 5]
    scale = [1, 30][case % 2]
    features = np.column_stack([np.ones(count), random.random(count) * scale, random.normal(size=count)])
    truth = random.normal(size=3) * 3
    right = random.random(count) < 1 / (1 + np.exp(-np.clip(features @ truth, -50, 50)))
    if case >= 35:  # a line separates them
        right = features @ truth > 0
    prior, spreads = random.normal(size=3) * 5, random.random(3) * 5 + 0.1
    lines = ["prior " + " ".join(map(repr, map(float, [*prior, *spreads])))]
    lines += [f"{int(r)} " + " ".join(map(repr, map(float, x))) for r, x in zip(right, features)]
    printed = subprocess.run([sys.argv[1]], input="\n".join(lines) + "\n", capture_output=True, text=True, check=True)
    ours = np.array(printed.stdout.split(), float)
    arguments = (features.reshape(-1, 3), right, prior, spreads)
    theirs = minimize(loss, prior, arguments, method="BFGS", options={"gtol": 1e-9}).x
    excess = loss(ours, *arguments) - loss(theirs, *arguments)
    assert excess < 1e-9, f"case {case}: {ours} is worse than {theirs} by {excess}"
    worst = max(worst, np.abs(ours - theirs).max())
assert worst < 1e-3, worst
print(f"40 fits, weights within {worst:.1e}")
