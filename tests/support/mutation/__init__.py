"""What `scripts/mutate` does: change one thing in a module, and see whether the tests that reach it notice."""

from ._mutants import Mutant, mutants_of
from ._reach import Reach, candidate_tests
from ._session import Outcome, Session

__all__ = ["Mutant", "Outcome", "Reach", "Session", "candidate_tests", "mutants_of"]
