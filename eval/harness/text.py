"""Words and tables for reports."""


def table(header, rows):
    """A Markdown table; the first column is text, the others are figures."""
    lines = [header, [':--'] + ['--:'] * (len(header) - 1)] + rows
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)


def listed(words):
    """'a', 'a and b', 'a, b and c'."""
    words = list(words)
    return ' and '.join([', '.join(words[:-1])] * (len(words) > 1) + words[-1:]) or 'none'


def bullets(sentences):
    return '\n'.join('- ' + sentence for sentence in sentences)


def less(quick, words):
    """What a quick run did not do, as a sentence to end a paragraph with; nothing for a full one."""
    return ' Quick: %s.' % words if quick else ''
