#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Tables of runs of one room with several seeds: those of docs/design/tried.md.

    scripts/seed_table.py RECORDS.jsonl [--base NAME]
    scripts/seed_table.py docs/results/priors_8000.jsonl --scenes perfect good default poor bad

Mean and standard deviation over seeds of each variant (the record's `name`, else its method); with --base the
differences of runs with the same seed to that variant, from the smallest to the largest; with --scenes a table for
each metric, a column for each of the scenes.
"""

import argparse
import json
import statistics

COLUMNS = [  # title, metric, decimals
    ("PSNR", "psnr", 2), ("glass", "psnr@glass", 2), ("opaque", "psnr@opaque", 2), ("SSIM", "ssim-3dgs", 3),
    ("Normal MAE", "normal-mae", 1), ("AbsRel on glass", "depth-absrel@glass", 3), ("t IoU", "transparency-iou", 3),
    ("behind", "behind-absrel", 3), ("content", "behind-absrel-content", 3), ("beyond", "behind-absrel-beyond", 3),
    ("trans-PSNR", "trans-psnr", 1), ("refl-PSNR", "refl-psnr", 1), ("CD (dm)", "mesh-cd", 2),
    ("CD without panes (dm)", "behind-mesh-cd", 2), ("surfels", "num-surfels", 0),
]
IN_DM = {"mesh-cd", "behind-mesh-cd"}


def value(record, metric):
    """The metric in the column's unit, or None."""
    found = record["metrics"].get(metric)
    return found * 10 if found is not None and metric in IN_DM else found


def by_variant(path):
    """name -> seed -> record, in the file's order; the last record of a seed counts."""
    variants = {}
    with open(path, encoding="utf-8") as lines:
        for record in map(json.loads, lines):
            name = record.get("name", record["method"])
            if record["status"] == "ok":
                variants.setdefault(name, {})[record["seed"]] = record
    return variants


def mean_cell(values, decimals):
    values = [v for v in values if v is not None]
    if not values:
        return "-"
    mean = f"{statistics.mean(values):.{decimals}f}"
    return mean if len(values) < 2 or decimals == 0 else f"{mean} ± {statistics.stdev(values):.{decimals}f}"


def difference_cell(runs, base, metric, decimals):
    pairs = [(value(runs[s], metric), value(base[s], metric)) for s in runs if s in base]
    pairs = [a - b for a, b in pairs if a is not None and b is not None]
    return f"{min(pairs):+.{decimals}f} to {max(pairs):+.{decimals}f}" if pairs else "-"


def print_scenes(path, scenes, titles):
    with open(path, encoding="utf-8") as lines:
        records = [record for record in map(json.loads, lines) if record["status"] == "ok"]
    for title, metric, decimals in COLUMNS:
        if titles and title not in titles:
            continue
        print_row([title] + scenes)
        print_row(["---"] + ["---:"] * len(scenes))
        for method in dict.fromkeys(record["method"] for record in records):
            runs = {(r["scene"], r["seed"]): value(r, metric) for r in records if r["method"] == method}
            cells = [mean_cell([v for (s, _), v in runs.items() if s == scene], decimals) for scene in scenes]
            if set(cells) != {"-"}:
                print_row([method] + cells)
        print()


def print_row(cells):
    print("| " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records")
    parser.add_argument("--base", help="variant that the others are compared with")
    parser.add_argument("--scenes", nargs="+", help="a table for each metric, with these columns")
    parser.add_argument("--only", nargs="+", metavar="TITLE", help="of those tables")
    arguments = parser.parse_args()
    if arguments.scenes:
        return print_scenes(arguments.records, arguments.scenes, arguments.only)
    variants = by_variant(arguments.records)
    if arguments.base and arguments.base not in variants:
        parser.error(f"no variant '{arguments.base}' in {arguments.records}; it has: {'; '.join(variants)}")
    print_row([f"less `{arguments.base}`" if arguments.base else "", "seeds"] + [title for title, _, _ in COLUMNS])
    print_row(["---"] + ["---:"] * (1 + len(COLUMNS)))
    for name, runs in variants.items():
        if name == arguments.base:
            continue
        cell = lambda metric, decimals: (
            difference_cell(runs, variants[arguments.base], metric, decimals) if arguments.base
            else mean_cell([value(run, metric) for run in runs.values()], decimals))
        print_row([name, str(len(runs))] + [cell(metric, decimals) for _, metric, decimals in COLUMNS])


if __name__ == "__main__":
    main()
