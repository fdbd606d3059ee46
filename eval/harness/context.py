"""Resources of an experiment: the built programs, the models, a scratch folder, and the amount of work."""

import json
import os
from dataclasses import dataclass

HERE = os.path.dirname(os.path.abspath(__file__))
EVAL = os.path.dirname(HERE)
ROOT = os.path.dirname(EVAL)


@dataclass(frozen=True)
class Case:
    """A model, its target number of vertices, whether it is a CAD part whose sharp edges must stay, and the only
    experiment that uses it; None if all do."""
    name: str
    path: str
    points: int
    sharp: bool = False
    only: str | None = None


@dataclass
class Context:
    """Argument of `run` of every experiment. `scratch` is an empty folder, `figures` the folder for pictures."""
    cases: list[Case]
    scratch: str
    figures: str
    quick: bool = False
    seed: int = 0
    binary: str = os.path.join(ROOT, 'target', 'release', 'remesh')

    def example(self, name):
        """Returns the path of a built example of the package."""
        return os.path.join(ROOT, 'target', 'release', 'examples', name)

    def case(self, name):
        """Returns the case with this name, or None if its model is not available."""
        return next((c for c in self.cases if c.name == name), None)

    def file(self, name):
        """Returns a path in the scratch folder."""
        return os.path.join(self.scratch, name)


def cases_at_hand(models):
    """Returns the cases of eval/cases.json whose files are in data/ or in `models`, and the names of the others."""
    with open(os.path.join(EVAL, 'cases.json'), encoding='utf-8') as f:
        listed = json.load(f)
    found, missing = [], []
    for case in listed:
        own = case['file'].startswith('data/')
        path = os.path.join(ROOT if own else models or '', case['file'])
        if (own or models) and os.path.isfile(path):
            found.append(Case(case['name'], path, case['points'], case.get('sharp', False), case.get('only')))
        else:
            missing.append(case['name'])
    return found, missing
