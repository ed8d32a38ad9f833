"""The front of `fivebar design` beside that of NSGA-II (pymoo) with as many evaluations of the same areas.

    python tests/peers/front.py [--front 5 20] [--seeds 1 2] [--write docs/verify/front.md]

Both seek arms with a larger area and more dexterity, 1/κ ≥ 0.5. The measure is the hypervolume: the part of the rectangle
from size 0 and 1/κ = 0, the reference point, to the largest area found and 1/κ = 1 that a front dominates. Of
NSGA-II's 100 arms the best choice of as many as ours is measured. Means over the seeds, and the least lead.
"""

import argparse
import itertools
import sys
import time
from pathlib import Path

import fivebar
import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

POPULATION = 100
LEG = """
symmetric = true
base = {base}
link_sum = 0.3
[area]
{area}
[require]
dexterity = 0.5
[objective]
maximise = "size"
front = {front}
"""
CASES = {
    "a ring, coaxial": ('kind = "annulus"', [0.0, 0.0]),
    "a square, base up to 0.1 m": ('kind = "square"', [0.0, 0.1]),
    "a wide rectangle, base 0.05 to 0.2 m": ('kind = "rectangle"\naspect = 2.0', [0.05, 0.2]),
    "a tall rectangle, base 0.02 to 0.3 m": ('kind = "rectangle"\naspect = 0.6', [0.02, 0.3]),
}


def hypervolume(points, size):
    """Of (size, dexterity), as a share of the rectangle from (0, 0) to (size, 1)."""
    volume, above = 0.0, 0.0
    for area, reached in sorted(points, reverse=True):
        if area > 0.0 and reached > above:
            volume += area * (reached - above)
            above = reached
    return volume / size


def chosen(points, count):
    """The choice of so many points with the greatest hypervolume: exact, by dynamic programming over the front."""
    front, above = [], 0.0
    for area, reached in sorted(set(points), reverse=True):
        if area > 0.0 and reached > above:
            front.append((area, reached))
            above = reached
    # best[i]: the greatest volume of a choice that ends with point i, and the choice.
    best = [(area * reached, [i]) for i, (area, reached) in enumerate(front)]
    whole = max(best, default=(0.0, []))
    for _ in range(count - 1):
        best = [max(((volume + area * (reached - front[choice[-1]][1]), [*choice, i])
                     for volume, choice in best[:i] if choice[-1] < i), default=(-1.0, [i]))
                for i, (area, reached) in enumerate(front)]
        whole = max(whole, max(best, default=whole))
    return [front[i] for i in whole[1]]


class Lengths(Problem):
    """Base, the crank's share, the place, and the area's size by the links' sum."""

    def __init__(self, specification, base):
        low, high = [base[0], 0.02, 0.0, 0.0], [base[1], 0.98, 1.0, 2.0]
        super().__init__(n_var=4, n_obj=2, n_ieq_constr=1, xl=np.array(low), xu=np.array(high))
        self.specification = specification

    def _evaluate(self, x, out, *args, **kwargs):
        base, share, y, size = x.T
        links = 0.3 - 0.5 * base
        crank, coupler = share * links, (1.0 - share) * links
        rows = np.stack([crank, coupler, coupler, crank, base, size * links, 0.0 * y, y * links], 1)
        dexterity = fivebar.dexterities(self.specification, rows)
        out["F"] = np.stack([-size * links, -dexterity], 1)
        out["G"] = (0.5 - dexterity)[:, None]


def compared(area, base, front, seed):
    specification = LEG.format(area=area, base=base, front=front)
    started = time.perf_counter()
    found = fivebar.design(specification, seed=seed).figures
    ours, spent = [(d["size"], d["dexterity"]) for d in found["front"]], time.perf_counter() - started
    started = time.perf_counter()
    result = minimize(Lengths(specification, base), NSGA2(pop_size=POPULATION),
                      ("n_evals", found["evaluations"]), seed=seed)
    theirs = [(-size, -dexterity) for size, dexterity in result.F.tolist()]
    slower = time.perf_counter() - started
    largest = max(size for size, _ in ours)
    volumes = [hypervolume(points, largest) for points in (ours, chosen(theirs, len(ours)))]
    return found["evaluations"], *volumes, max(size for size, _ in theirs) / largest, (spent, slower)


def table(runs):
    """A row for each area and number of arms: the means over the seeds, and the least lead."""
    lines = ["| area | arms | evaluations | `fivebar design` | NSGA-II | least lead |", "|---|---|---|---|---|---|"]
    for (name, front), found in runs.items():
        evaluations, ours, theirs = np.mean(found, axis=0)
        lead = min(ours - theirs for _, ours, theirs in found)
        lines.append(f"| {name} | {front} | {evaluations:,.0f} | {ours:.4f} | {theirs:.4f} | {lead:.4f} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--front", type=int, nargs="+", default=[5], help="designs")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--cases", type=int, nargs="+", default=range(len(CASES)), help="their numbers, from 0")
    parser.add_argument("--write", type=Path, metavar="FILE.md")
    given = parser.parse_args()
    runs, worse = {}, 0
    for front, case, seed in itertools.product(given.front, given.cases, given.seeds):
        name, (area, base) = list(CASES.items())[case]
        evaluations, ours, theirs, largest, times = compared(area, base, front, seed)
        worse += theirs > ours
        runs.setdefault((name, front), []).append((evaluations, ours, theirs))
        print(f"{name}: {front} arms, seed {seed}, {evaluations:,} evaluations, {ours:.4f}, NSGA-II {theirs:.4f}, "
              f"its largest area by ours {largest:.5f}, {times[0]:.1f} s, {times[1]:.1f} s", flush=True)
    if given.write:
        options = " ".join(["--front", *map(str, given.front), "--seeds", *map(str, given.seeds)])
        page = __doc__.split("\n\n")[2].strip()
        given.write.write_text(
            "# The front beside NSGA-II\n\n"
            f"`python tests/peers/front.py {options} --write docs/verify/front.md` makes this page.\n"
            f"{page}\n\n{table(runs)}\n", encoding="utf-8")
    sys.exit(f"front: NSGA-II is better {worse} times" if worse else 0)


if __name__ == "__main__":
    main()
