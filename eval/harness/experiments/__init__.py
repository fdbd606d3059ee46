"""The experiments, in the order in which RESULTS.md has them.

Each is a module with

    TITLE                      its heading in RESULTS.md
    run(context) -> dict       measures, and gives its raw figures as what JSON can hold
    report(raw, figures) -> str
                               Markdown from the raw figures alone; draws plots into the folder `figures`, names them by
                               `figures/NAME.svg`, and says in words what is better and what is worse than the peer

and may have

    watched(raw) -> dict       figures of ours that `eval/run compare` watches: name -> (value, sense, noise); see
                               compare.py

`run` does less with `context.quick`, and says in its figures what it left out and why.
"""

NAMES = ['cases', 'remeshers', 'cad', 'table1', 'clouds', 'dense', 'large', 'table2', 'figure04', 'figure05', 'figure07',
         'figure08', 'figure10', 'figure11', 'figure12_14', 'figure16']
