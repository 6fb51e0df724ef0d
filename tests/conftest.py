"""Under mpirun only rank 0 reports; the outcome of a test is the worst over all ranks."""

import os

import pytest
from mpi4py import MPI


@pytest.hookimpl(trylast=True)
def pytest_configure(config: pytest.Config) -> None:
    if MPI.COMM_WORLD.rank != 0:
        reporter = config.pluginmanager.get_plugin("terminalreporter")
        if reporter is not None:
            reporter._tw._file = open(os.devnull, "w")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo):
    outcome = yield
    if call.when == "call" and MPI.COMM_WORLD.size > 1:
        report = outcome.get_result()
        worst = MPI.COMM_WORLD.allreduce(int(report.failed), op=MPI.MAX)
        if worst and not report.failed:
            report.outcome, report.longrepr = "failed", "failed on another rank"
