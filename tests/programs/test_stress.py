"""A stress test: more than a thousand generated mechanisms, run by the program and followed apart from it (tests/scripts/stress.py).

Data files of failures are kept in the folder that MECH9_STRESS_KEEP names.
"""
import pytest

from stress import SEED, Stress, run_variant, variants


@pytest.mark.parametrize('family, number', variants())
def test_generated_mechanisms(checks, tmp_path, build, mech9k, family, number):
    """A thousand mechanisms in the optimised build, a hundred in the others."""
    run_variant(Stress(mech9k, tmp_path, SEED, checks), family, number, 25 if build.optimised else 2)
