"""Prints the comparison as a table in Markdown."""


def number(value, form):
    return "" if value is None else format(value, form)


def print_table(table):
    """Prints one work: a row per tool, the slowest last."""
    smooth = any("largest_error" in row for row in table["rows"].values())
    print(f"\n{table['work'].upper()}: {table['runs']} runs. Reference: {table['reference']}.\n")
    errors = ["largest error"] if smooth else ["labels that differ", "median error of angles, rad"]
    head = ["tool", "CPU ms per run", "over the first of stickslip", "right-hand sides", "steps", "events"]
    head += ["tolerance", *errors, "rounds"]
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    for row in sorted(table["rows"].values(), key=lambda row: row["cpu_ms_per_run"]):
        cells = [
            row["tool"],
            number(row["cpu_ms_per_run"], ".3g"),
            number(row["ratio"], ".2f"),
            *(number(row[name], ".0f") for name in ("evaluations", "steps", "events")),
            number(row["relative_tolerance"], ".0e"),
        ]
        if smooth:
            cells.append(number(row["largest_error"], ".1e"))
        else:
            cells.append(str(row["labels_that_differ"]))
            cells.append(number(row["median_angle_error"], ".1e"))
        print("| " + " | ".join([*cells, str(row["rounds"])]) + " |")
