#!/usr/bin/env python3
"""Measure the release build on real models, and write the table of figures into README.md.

    cargo build --release
    eval/figures.py [--models FOLDER] [--only NAME,NAME] [--print]

The cases are those of eval/cases.json; eval/peers.json has what other remeshers reach on some of them, for the tables that
put both side by side. Files that begin with data/ are the project's own; the others are looked for in
FOLDER, and left out with a note where they are not there. One run with --report gives the figures of the result. Three
more runs without it, as a user would type them, are timed as whole processes: the table has the median of their wall
seconds, and the most memory that any of them had resident. (About 20 MB are the least that can be seen: what this
script itself has resident when it starts a run counts for it.)

Exit status: 0 all measured, 1 a run failed or a result was not verified, 2 wrong usage.
"""

import argparse
import datetime
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)
README = os.path.join(ROOT, 'README.md')
BEGIN, END = '<!-- figures:begin -->', '<!-- figures:end -->'
REPEATS = 3
SCHEMA = 'spectral-remesh/report/1'

# Heading, alignment, and the text of a cell from a case's result.
COLUMNS = [
    ('model', ':--', lambda r: r['name']),
    ('vertices in', '--:', lambda r: '{:,}'.format(r['report']['input']['topology']['vertices'])),
    ('asked', '--:', lambda r: '{:,}'.format(r['points'])),
    ('out', '--:', lambda r: '{:,}'.format(r['report']['output']['topology']['vertices'])),
    ('Qave', '--:', lambda r: '%.3f' % shape(r)['q_mean']),
    ('Qmin', '--:', lambda r: '%.2f' % shape(r)['q_min']),
    ('θmin', '--:', lambda r: '%.1f' % shape(r)['theta_min']),
    ('mean θmin', '--:', lambda r: '%.1f' % shape(r)['theta_min_mean']),
    ('θmax', '--:', lambda r: '%.1f' % shape(r)['theta_max']),
    ('% < 30°', '--:', lambda r: '%.2f' % shape(r)['percent_below_30']),
    ('% valence 6', '--:', lambda r: optional('%.1f', shape(r)['percent_valence_6'])),
    ('RMS %', '--:', lambda r: optional('%.3f', distance(r, 'rms'))),
    ('Hausdorff %', '--:', lambda r: optional('%.2f', distance(r, 'hausdorff'))),
    ('seconds', '--:', lambda r: '%.2f' % r['seconds']),
    ('MB', '--:', lambda r: '%.0f' % r['megabytes']),
    ('verified', ':-:', lambda r: 'yes' if r['report']['verified'] else 'no'),
]


def shape(result):
    return result['report']['output']['shape']


def distance(result, key):
    return (result['report']['distance'] or {}).get(key)


def optional(form, value):
    return 'n/a' if value is None else form % value


class Failed(Exception):
    pass


def run(command):
    """Runs a command to its end: its exit status, wall seconds, and most resident memory in megabytes."""
    with tempfile.TemporaryFile() as said:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = code = os.waitstatus_to_exitcode(status)
        said.seek(0)
        lines = said.read().decode(errors='replace').strip().splitlines()
    # 0 is a verified result, 3 one that was written and not verified.
    if code not in (0, 3):
        raise Failed('exit status %d: %s' % (code, lines[-1] if lines else 'no message'))
    unit = 1e6 if sys.platform == 'darwin' else 1e6 / 1024
    return seconds, usage.ru_maxrss / unit


def measure(binary, case, source, scratch):
    """All figures of one case."""
    target = os.path.join(scratch, 'out.ply')
    report = os.path.join(scratch, 'report.json')
    command = [binary, source, target, '--points', str(case['points'])]
    run(command + ['--report', report])
    with open(report, encoding='utf-8') as f:
        found = json.load(f)
    if found['schema'] != SCHEMA:
        raise Failed('its report is of schema %s, and this script reads %s' % (found['schema'], SCHEMA))
    if found['output']['shape'] is None:
        raise Failed('its result has no triangles')
    runs = [run(command) for _ in range(REPEATS)]
    return {
        'name': case['name'],
        'points': case['points'],
        'report': found,
        'seconds': statistics.median(seconds for seconds, _ in runs),
        'megabytes': max(megabytes for _, megabytes in runs),
    }


def place_of(case, models):
    if case['file'].startswith('data/'):
        return os.path.join(ROOT, case['file'])
    return os.path.join(models, case['file']) if models else None


def chosen(cases, only):
    names = only.split(',') if only else [c['name'] for c in cases]
    unknown = set(names) - {c['name'] for c in cases}
    if unknown:
        sys.stderr.write('figures: no case is called %s\n' % ', '.join(sorted(unknown)))
        sys.exit(2)
    return [c for c in cases if c['name'] in names]


def measure_all(binary, cases, models):
    """The results, and the number of cases that failed or were not verified."""
    results, bad = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        for case in cases:
            source = place_of(case, models)
            if source is None or not os.path.isfile(source):
                sys.stderr.write('%-12s left out: no %s\n' % (case['name'], source or case['file']))
                continue
            try:
                result = measure(binary, case, source, scratch)
            except Failed as failure:
                sys.stderr.write('%-12s failed, %s\n' % (case['name'], failure))
                results.append({'name': case['name'], 'points': case['points'], 'report': None})
                bad += 1
                continue
            sys.stderr.write('%-12s %.2f s, Qave %.3f\n' % (case['name'], result['seconds'], shape(result)['q_mean']))
            bad += not result['report']['verified']
            results.append(result)
    return results, bad


def cells(result):
    """The row of a case. One that failed keeps its row."""
    if result['report'] is None:
        blanks = [''] * (len(COLUMNS) - 4)
        return [result['name'], '', '{:,}'.format(result['points'])] + blanks + ['failed']
    return [cell(result) for _, _, cell in COLUMNS]


def table(results):
    rows = [[heading for heading, _, _ in COLUMNS], [align for _, align, _ in COLUMNS]]
    rows += [cells(r) for r in results]
    return '\n'.join('| ' + ' | '.join(row) + ' |' for row in rows)


def beside(results, peers):
    """Our figures and those of other programs, a table for each measure."""
    ours = {r['name']: r for r in results if r['report']}
    models = [m for m in peers['models'] if m in ours]
    if not models:
        return ''
    own = {
        'angles': lambda r: '%.1f / %.1f' % (shape(r)['theta_min'], shape(r)['theta_min_mean']),
        'quality': lambda r: '%.2f / %.3f' % (shape(r)['q_min'], shape(r)['q_mean']),
        'distance': lambda r: '%.3f / %.2f' % (distance(r, 'rms'), distance(r, 'hausdorff')),
        'seconds': lambda r: '%.2f' % r['seconds'],
    }
    parts = []
    for measure in peers['measures']:
        rows = [[measure['title']] + models, [':--'] + ['--:'] * len(models)]
        rows.append(['**remesh**'] + ['**%s**' % own[measure['key']](ours[m]) for m in models])
        rows += [[name] + [row[m] for m in models] for name, row in measure['rows'].items()]
        parts.append('\n'.join('| ' + ' | '.join(row) + ' |' for row in rows))
    programs = ', '.join('%s (%s)' % item for item in peers['programs'].items())
    head = 'Other programs at the same counts, measured on %s: %s. Our seconds are those of the whole process.' % (
        peers['measured'], programs)
    return '\n\n%s\n\n%s' % (head, '\n\n'.join(parts))


def points_of(binary, source, target):
    """Writes the vertices of a mesh with their normals as rows of a text file; the same without normals."""
    # A kernel so narrow keeps every point.
    run([binary, 'sample', source, target, '--scan-only', '--sigma-p', '1e-7'])
    bare = target.replace('.xyz', '.bare.xyz')
    with open(target, encoding='utf-8') as rows, open(bare, 'w', encoding='utf-8') as out:
        out.writelines(' '.join(row.split()[:3]) + '\n' for row in rows if not row.startswith('#'))
    return {'with normals': target, 'without normals': bare}


def figures_of_points(binary, case, source, scratch):
    """The report of the mesh of a model's vertices, held against the model, with and without normals."""
    found = {}
    for kind, cloud in points_of(binary, source, os.path.join(scratch, 'points.xyz')).items():
        target = os.path.join(scratch, 'out.ply')
        run([binary, cloud, target, '--points', str(case['points']), '-q'])
        command = [binary, 'quality', target, '--against', source, '--json']
        found[kind] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found


def from_points(binary, cases, models, peers):
    """A table of what becomes of the vertices of some models alone."""
    rows = {}
    with tempfile.TemporaryDirectory() as scratch:
        for case in (c for c in cases if c['name'] in peers['models']):
            source = place_of(case, models)
            if source and os.path.isfile(source):
                rows[case['name']] = figures_of_points(binary, case, source, scratch)
    if not rows:
        return ''
    names = [m for m in peers['models'] if m in rows]

    def kind(topology):
        return [topology[key] for key in ('euler', 'components', 'boundary_loops')]

    def angles(report):
        return '%.1f / %.1f' % (report['output']['shape']['theta_min'], report['output']['shape']['theta_min_mean'])

    def fit(report):
        same = kind(report['output']['topology']) == kind(report['input']['topology'])
        q = report['output']['shape']['q_mean']
        return '%.3f / %.3f / %s' % (q, report['distance']['rms'], 'yes' if same else 'no')

    lines = [['From points: θmin / mean θmin'] + names, [':--'] + ['--:'] * len(names)]
    both = list(rows[names[0]])
    lines += [['**remesh, %s**' % k] + ['**%s**' % angles(rows[m][k]) for m in names] for k in both]
    lines += [[peers['program']] + [peers['angles'][m] for m in names]]
    fits = [['From points: Qave / RMS distance to the mesh / its topology'] + names, lines[1]]
    fits += [['**remesh, %s**' % k] + ['**%s**' % fit(rows[m][k]) for m in names] for k in both]
    head = 'The vertices of some models alone, as point clouds, at the same counts. ' + peers['note']
    text = ['\n'.join('| ' + ' | '.join(row) + ' |' for row in part) for part in (lines, fits)]
    return '\n\n%s\n\n%s' % (head, '\n\n'.join(text))


def machine():
    return '%d cores, %s, %s' % (os.cpu_count() or 1, platform.machine(), platform.system())


def section(results, peers, points):
    """What stands between the markers."""
    versions = sorted({r['report']['version'] for r in results if r['report']})
    head = 'Version %s, measured on %s (%s). Written by `eval/figures.py --models FOLDER`; do not edit.' % (
        ', '.join(versions) or 'unknown', datetime.date.today().isoformat(), machine())
    return '%s\n%s\n\n%s%s%s\n%s' % (BEGIN, head, table(results), beside(results, peers), points, END)


def rewrite(text):
    with open(README, encoding='utf-8') as f:
        readme = f.read()
    if readme.count(BEGIN) != 1 or readme.count(END) != 1 or readme.index(BEGIN) > readme.index(END):
        sys.exit('figures: README.md needs one %s and, after it, one %s' % (BEGIN, END))
    before, rest = readme.split(BEGIN)
    new = README + '.new'
    with open(new, 'w', encoding='utf-8') as f:
        f.write(before + text + rest.split(END)[1])
    os.replace(new, README)


def main():
    arguments = argparse.ArgumentParser(description='Write the table of figures into README.md.')
    arguments.add_argument('--models', metavar='FOLDER', help='where the models of eval/cases.json are')
    arguments.add_argument('--only', metavar='NAME,NAME', help='only these cases; implies --print')
    arguments.add_argument('--binary', default=os.path.join(ROOT, 'target', 'release', 'remesh'))
    arguments.add_argument('--print', action='store_true', help='print the table and leave README.md alone')
    options = arguments.parse_args()
    if not os.path.isfile(options.binary):
        sys.exit('figures: no %s; run `cargo build --release` first' % options.binary)
    with open(os.path.join(HERE, 'cases.json'), encoding='utf-8') as f:
        cases = chosen(json.load(f), options.only)
    with open(os.path.join(HERE, 'peers.json'), encoding='utf-8') as f:
        peers = json.load(f)
    results, bad = measure_all(options.binary, cases, options.models)
    if not results:
        sys.exit('figures: nothing was measured')
    points = from_points(options.binary, cases, options.models, peers['points'])
    if options.print or options.only:
        print(section(results, peers, points))
    else:
        rewrite(section(results, peers, points))
    sys.exit(1 if bad else 0)


if __name__ == '__main__':
    main()
