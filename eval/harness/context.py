"""What an experiment may use: the built programs, the models, a scratch folder, and how much to do."""

import json
import os
from dataclasses import dataclass

HERE = os.path.dirname(os.path.abspath(__file__))
EVAL = os.path.dirname(HERE)
ROOT = os.path.dirname(EVAL)


@dataclass(frozen=True)
class Case:
    """A model, the number of vertices wanted of it, whether it is a CAD part whose sharp edges are to stay, and the one
    experiment that takes it; None if all do."""
    name: str
    path: str
    points: int
    sharp: bool = False
    only: str | None = None


@dataclass
class Context:
    """Handed to `run` of every experiment. `scratch` is an empty folder, `figures` the one for pictures."""
    cases: list[Case]
    scratch: str
    figures: str
    quick: bool = False
    seed: int = 0
    binary: str = os.path.join(ROOT, 'target', 'release', 'remesh')

    def example(self, name):
        """The path of a built example of the package."""
        return os.path.join(ROOT, 'target', 'release', 'examples', name)

    def case(self, name):
        """The case of that name, or None where its model is not at hand."""
        return next((c for c in self.cases if c.name == name), None)

    def file(self, name):
        """A path in the scratch folder."""
        return os.path.join(self.scratch, name)


def cases_at_hand(models):
    """The cases of eval/cases.json whose files are in data/ or in the folder `models`, and the names of the others."""
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
