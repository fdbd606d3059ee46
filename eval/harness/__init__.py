"""Runs the paper's experiments with this implementation and the comparison with other remeshers, in one command."""
