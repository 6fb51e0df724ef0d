"""The search: Optuna proposes designs, the ranks try them, and its storage keeps what is known."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from mpi4py import MPI

from swgpar.errors import InputError, OutputError, SwgparError
from swgpar.input.quantities import show
from swgpar.optimisation.problem import Evaluation, Problem
from swgpar.optimisation.spec import OptimiseSection, Variable
from swgpar.results.atomic import on_all, on_root, reason_of
from swgpar.studies.many_runs import do_runs
from swgpar.tasks import Send

if TYPE_CHECKING:
    import optuna

JOURNAL = "optimise.journal"
"""The embedded storage: a file to which every rank appends, also on network file systems."""

KEPT = ("status", "reason", "quantities", "verdicts", "wall_s")
"""What a trial keeps of an `Evaluation` beside its values and violations."""

T = TypeVar("T")

Receive = Callable[[tuple[int, Evaluation]], None]
"""Takes the number of an evaluation and what became of it."""


def import_optuna() -> Any:
    """Optuna, with its log switched off; raises InputError where it is not installed."""
    try:
        import optuna
    except ImportError:
        raise InputError(
            "swgpar optimise needs the package optuna: install it with pip install optuna"
        ) from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna


def _stored(comm: MPI.Comm, where: str, task: Callable[[], T]) -> T:
    """Result of a task on a storage, on every rank its own; an error of any library becomes an
    OutputError of all."""

    def guarded() -> T:
        try:
            return task()
        except SwgparError:
            raise
        except Exception as error:
            reason = reason_of(getattr(error, "orig", None) or error)  # that of the database
            raise OutputError(f"the storage {where} cannot be used: {reason}") from None

    return on_all(comm, guarded)


def open_storage(url: str, folder: Path, comm: MPI.Comm) -> optuna.storages.BaseStorage:
    """The database of a URL, or the journal in the folder; collective. Rank 0 opens it first, and
    makes its tables."""

    def opened() -> optuna.storages.BaseStorage:
        optuna = import_optuna()
        if url:
            return optuna.storages.RDBStorage(url)
        return optuna.storages.JournalStorage(
            optuna.storages.journal.JournalFileBackend(str(folder / JOURNAL))
        )

    where = on_all(comm, lambda: _without_password(url)) if url else str(folder / JOURNAL)
    if comm.rank == 0 and not url:
        _break_lock(folder)
    first = _stored(comm, where, lambda: opened() if comm.rank == 0 else None)
    return _stored(comm, where, lambda: first or opened())


def _without_password(url: str) -> str:
    """The URL of a database for messages. Raises InputError where it is none, or that of a database
    in memory."""
    import_optuna()
    from sqlalchemy.engine import make_url
    from sqlalchemy.exc import ArgumentError

    try:
        found = make_url(url)
        if "@" in (found.host or ""):  # of the password
            raise ValueError
    except (ArgumentError, ValueError):  # their words may have a part of the password
        raise InputError(
            "optimise.storage is no URL of a database: allowed are sqlite:///FILE and "
            "DIALECT://USER:PASSWORD@HOST/NAME, with %40 for @, %3A for : and %2F for / in a "
            "password"
        ) from None
    if found.get_backend_name() == "sqlite" and found.database in (None, "", ":memory:"):
        raise InputError(
            f"optimise.storage = {show(url)} is in the memory of one process, and lost at its end: "
            "allowed are files, sqlite:///FILE, or none for a file in the folder of the results"
        )
    return f"{found.drivername} {found.database}"


def _break_lock(folder: Path) -> None:
    """Remove Optuna's lock that a killed search has left: nobody else has the folder, and Optuna
    would wait for 30 s without a word."""
    for left in folder.glob(f"{JOURNAL}.lock*"):
        if left.is_symlink():  # as Optuna makes them
            left.unlink()


def _sampler(section: OptimiseSection, rank: int) -> optuna.samplers.BaseSampler:
    names = {"tpe": "TPESampler", "nsga2": "NSGAIISampler", "random": "RandomSampler"}
    sampler = getattr(import_optuna().samplers, names[section.sampler])
    return sampler(seed=section.seed + rank)


def distribution(variable: Variable) -> optuna.distributions.BaseDistribution:
    """The values that a variable may take."""
    distributions = import_optuna().distributions
    if variable.choices:
        return distributions.CategoricalDistribution(variable.choices)
    if variable.integer:
        low, high = int(variable.low), int(variable.high)
        return distributions.IntDistribution(low, high, log=variable.log)
    return distributions.FloatDistribution(variable.low, variable.high, log=variable.log)


class Search:
    """One search in a storage, on all ranks of a communicator; collective unless said otherwise.

    storage : of this rank;  name : of the search in the storage
    first : designs that are tried first, unless the search knows them
    own : whether nobody else uses the storage, so that evaluations without an end belong to a call
    that was interrupted
    """

    def __init__(
        self,
        problem: Problem,
        storage: optuna.storages.BaseStorage,
        name: str,
        comm: MPI.Comm,
        first: list[dict[str, Any]],
        own: bool,
    ) -> None:
        self.problem, self.comm, self.name = problem, comm, name
        self._distributions = {
            variable.name: distribution(variable) for variable in problem.section.variable
        }

        def load() -> optuna.Study:
            sampler = _sampler(problem.section, comm.rank)
            return import_optuna().load_study(study_name=name, storage=storage, sampler=sampler)

        def create() -> None:
            if comm.rank == 0:
                self._create(storage, first, own)

        _stored(comm, f"of {name}", create)
        self.study = _stored(comm, f"of {name}", load)

    def _create(
        self, storage: optuna.storages.BaseStorage, first: list[dict[str, Any]], own: bool
    ) -> None:
        """Make the search or continue one of the same problem; on one rank."""
        optuna, problem = import_optuna(), self.problem
        directions = [
            objective.goal.replace("ise", "ize") for objective in problem.section.objective
        ]
        study = optuna.create_study(
            storage=storage, study_name=self.name, directions=directions, load_if_exists=True
        )
        identity = study.user_attrs.get("identity")
        if identity is None:
            study.set_user_attr("identity", problem.identity)
        elif identity != problem.identity:
            instead = "overwrite = true (--overwrite)"
            if not own:
                instead = (
                    "another name of the file or another database, from which --overwrite removes "
                    "nothing"
                )
            raise InputError(
                f"the storage holds a search {self.name} of another problem: allowed are the same "
                f"variables, objectives, constraints, design and mesh, or {instead}"
            )
        for values in first:  # a call that was killed here may have added some of them
            study.enqueue_trial(values, skip_if_exists=True)
        state = optuna.trial.TrialState
        for trial in study.get_trials(deepcopy=False, states=(state.RUNNING,)) if own else ():
            # interrupted: tried once more. In this order a kill between the two loses none. A
            # design that is given has its values in `fixed_params`, before they are its parameters
            if values := trial.system_attrs.get("fixed_params", {}) | trial.params:
                study.enqueue_trial(values)
            study.tell(trial.number, state=state.FAIL)

    def _complete(self) -> list[optuna.trial.FrozenTrial]:
        complete = import_optuna().trial.TrialState.COMPLETE
        return self.study.get_trials(deepcopy=False, states=(complete,))

    def evaluations(self) -> dict[int, Evaluation]:
        """All that have ended, by number; not collective."""
        return {trial.number: _evaluation(trial) for trial in self._complete()}

    def run(self, wanted: int, receive: Receive | None) -> None:
        """Try designs until `wanted` have ended. receive : called on rank 0, None on other ranks"""
        left = on_root(self.comm, lambda: max(wanted - len(self.evaluations()), 0))
        do_runs(self.comm, self.problem.section.parallel, left, self._try, receive)

    def _try(self, _: int, comm: MPI.Comm, send: Send) -> None:
        """Try one design on the ranks of `comm`."""
        trial = self.study.ask(self._distributions) if comm.rank == 0 else None
        evaluation = self.problem.evaluate(comm.bcast(trial.params if trial else None), comm)
        if trial:
            self._tell(trial, evaluation)
            send((trial.number, evaluation))

    def _tell(self, trial: optuna.Trial, evaluation: Evaluation) -> None:
        """Store an evaluation. A failed design is one of the worst values that violates a
        constraint."""
        for key in KEPT:
            trial.set_user_attr(key, getattr(evaluation, key))
        for text, amount in evaluation.violations.items():
            trial.set_constraint(text, amount)
        values = [
            evaluation.quantities.get(objective.name, objective.sign * float("inf"))
            for objective in self.problem.section.objective
        ]
        self.study.tell(trial, values)

    def best(self) -> list[int]:
        """Numbers of the best feasible design, or of those of the Pareto front; not collective."""
        ranked = self.ranked()
        if len(self.problem.section.objective) == 1:
            return ranked[:1]
        return [trial.number for trial in self.study.best_trials if trial.number in ranked]

    def ranked(self) -> list[int]:
        """Numbers of the feasible designs by their first objective, the best one first; not
        collective."""
        first = self.problem.section.objective[0]
        values = {
            number: first.sign * each.quantities[first.name]
            for number, each in self.evaluations().items()
            if each.status == "feasible"
        }
        return sorted(values, key=values.__getitem__)

    def importance(self) -> dict[str, dict[str, float]]:
        """Share of every variable in the best values of an objective, by PED-ANOVA; not collective.

        Empty with less than ten feasible designs, or one variable.
        """
        optuna = import_optuna()
        trials = [each for each in self._complete() if each.user_attrs["status"] == "feasible"]
        if len(trials) < 10 or len(self._distributions) < 2:
            return {}
        shares = {}
        for index, objective in enumerate(self.problem.section.objective):
            study = optuna.create_study(direction=self.study.directions[index])
            for trial in trials:
                one = {"distributions": trial.distributions, "value": trial.values[index]}
                study.add_trial(optuna.trial.create_trial(params=trial.params, **one))
            shares[objective.name] = optuna.importance.get_param_importances(
                study, evaluator=optuna.importance.PedAnovaImportanceEvaluator()
            )
        return shares


def _evaluation(trial: optuna.trial.FrozenTrial) -> Evaluation:
    stored = {key: trial.user_attrs[key] for key in KEPT}
    return Evaluation(values=dict(trial.params), violations=dict(trial.constraints), **stored)
