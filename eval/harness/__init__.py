"""The paper's experiments with this implementation, and the comparison with other remeshers, by one command."""
