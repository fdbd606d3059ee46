# Recipes for those who have `just`; each is one plain command that works without it.

# List the recipes.
default:
    @just --list

# The tests that are quick.
test:
    cargo test

# All tests.
test-all:
    cargo test -- --include-ignored

# The Python package, into the current environment, and its tests.
python:
    python -m pip install './python[test]'
    pytest python/tests

# What a browser makes of the pages of reports.
test-pages:
    cargo build --release
    npm ci --prefix viewer/test
    npm test --prefix viewer/test

# The extension for Blender, and its tests there.
test-blender:
    blender/test

# The package for Debian.
deb:
    packaging/deb

# The pages as a site.
site:
    docs/build

# The page that remeshes, into target/web, and its tests.
page:
    cargo build --release
    web/build
    npm ci --prefix viewer/test
    npm run test-web --prefix viewer/test

# Everything that must hold before a change is merged.
ci:
    .ci/run

# Write the models of data/ again.
data:
    cargo run --release --example make_data

# The picture of the README.
picture:
    cargo run --release -- data/blob.obj target/blob.out.obj --points 4000
    cargo run --release --example render -- data/blob.obj target/blob.out.obj data/before-after.png --size 600 --view 0,88

# Time every stage.
bench:
    cargo bench

# The paper's experiments and other remeshers on the models in FOLDER and in data/, into eval/RESULTS.md, docs/figures.md and the README.
figures FOLDER:
    eval/setup
    eval/run --models {{FOLDER}}
    eval/run readme
