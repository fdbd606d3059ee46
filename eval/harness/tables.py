"""Markdown tables and lists, and numbers as text."""


def markdown(rows):
    """A table: the first row is the heading, the first column its text."""
    lines = [rows[0], [':--'] + ['--:'] * (len(rows[0]) - 1)] + rows[1:]
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)


def number(form, value):
    """`value` in the printf form `form`, or a dash where there is none."""
    return '-' if value is None else form % value


def spread(values, form='%.2f'):
    """Median (least..greatest) of some numbers."""
    known = sorted(v for v in values if v is not None)
    if not known:
        return '-'
    middle = len(known) // 2
    median = known[middle] if len(known) % 2 else (known[middle - 1] + known[middle]) / 2
    if len(known) == 1:
        return form % median
    return '%s (%s..%s)' % tuple(form % v for v in (median, known[0], known[-1]))


def listed(names):
    """`a, b and c`"""
    names = list(names)
    if len(names) < 2:
        return names[0] if names else 'none'
    return '%s and %s' % (', '.join(names[:-1]), names[-1])


def bullets(sentences):
    return '\n'.join('- ' + sentence for sentence in sentences)


def less(quick, words):
    """What a quick run did not do, as a sentence to end a paragraph with; nothing for a full one."""
    return ' Quick: %s.' % words if quick else ''


def columns(title, names, rows):
    """A table of one column a model: `rows` is a list of a heading and a dict by model."""
    return markdown([[title] + names] + [[head] + [cells.get(name, '') for name in names] for head, cells in rows])
