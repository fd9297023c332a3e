"""Numbers with intervals, as cells of tables in the record; tests/docs/open_questions.rs formats them."""


def number(estimate, digits):
    """A number with this number of decimals; `estimate` is a value, or a value with the limits of its interval."""
    value, low, high = estimate if isinstance(estimate, tuple) else (estimate, None, None)

    def known(one):
        # Three further digits: the record does not depend on rounding errors.
        return None if one is None or one != one else round(float(one), digits + 3)

    return {"value": known(value), "low": known(low), "high": known(high), "digits": digits}


def percent(estimate, digits=0):
    """A fraction as a percentage."""
    if isinstance(estimate, tuple):
        return number(tuple(None if one is None else 100 * one for one in estimate), digits)
    return number(100 * estimate, digits)


def table(head, rows):
    """A table: names of columns, and rows of words and numbers."""
    assert all(len(row) == len(head) for row in rows), head
    return {"head": head, "rows": rows}
