"""Several processes of a study: the starter of MPI, and its environment."""
import os
import shutil

import pytest

# Debian's OpenMPI asks root for these; several processes share a core, and a container may forbid them to read each other's memory.
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1', OMPI_MCA_mpi_yield_when_idle='1',
                   OMPI_MCA_btl_vader_single_copy_mechanism='none', OMPI_MCA_btl_sm_single_copy_mechanism='none')


def mpi_of(build):
    """The program that starts several processes; skips the test where the build has no programs for them."""
    mpirun = shutil.which('mpiexec')
    if not mpirun or not build.has('mech9k-mpi'):
        pytest.skip('there is no mpiexec, or the programs are built without MPI (Debian: libopenmpi-dev, openmpi-bin)')
    return mpirun
