"""The experiments, in the order of RESULTS.md.

Each is a module with

    TITLE                      its heading in RESULTS.md
    run(context) -> dict       measures, and returns its raw figures as JSON-compatible values
    report(raw, figures) -> str
                               returns Markdown made from the raw figures only; draws plots into the folder `figures`,
                               refers to them as `figures/NAME.svg`, and says what is better and worse than the peer

and may have

    watched(raw) -> dict       our figures that `eval/run compare` watches: name -> (value, sense, noise);
                               see compare.py

With `context.quick`, `run` does less, and says in its figures what it left out and why.
"""

NAMES = ['cases', 'remeshers', 'cad', 'table1', 'clouds', 'dense', 'large', 'table2', 'figure04', 'figure05', 'figure07',
         'figure08', 'figure10', 'figure11', 'figure12_14', 'figure16']
