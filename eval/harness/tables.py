"""Formats Markdown tables, lists and numbers."""


def markdown(rows):
    """Returns a table whose first row is the heading and whose first column is text."""
    lines = [rows[0], [':--'] + ['--:'] * (len(rows[0]) - 1)] + rows[1:]
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)


def number(form, value):
    """Returns `value` in the printf format `form`, or a dash for None."""
    return '-' if value is None else form % value


def spread(values, form='%.2f'):
    """Returns `median (minimum..maximum)` of the known values."""
    known = sorted(v for v in values if v is not None)
    if not known:
        return '-'
    middle = len(known) // 2
    median = known[middle] if len(known) % 2 else (known[middle - 1] + known[middle]) / 2
    if len(known) == 1:
        return form % median
    return '%s (%s..%s)' % tuple(form % v for v in (median, known[0], known[-1]))


def listed(names):
    """Returns `a, b and c`."""
    names = list(names)
    if len(names) < 2:
        return names[0] if names else 'none'
    return '%s and %s' % (', '.join(names[:-1]), names[-1])


def bullets(sentences):
    return '\n'.join('- ' + sentence for sentence in sentences)


def less(quick, words):
    """Returns a closing sentence on what a quick run left out; an empty string for a full run."""
    return ' Quick: %s.' % words if quick else ''


def columns(title, names, rows):
    """Returns a table with one column per model: `rows` is a list of pairs of a heading and a dict by model."""
    return markdown([[title] + names] + [[head] + [cells.get(name, '') for name in names] for head, cells in rows])
