"""The search: Optuna proposes designs, the ranks try them, and its storage keeps what is known."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from mpi4py import MPI

from swgpar.errors import InputError, OutputError, SwgparError
from swgpar.optimisation.problem import Evaluation, Problem
from swgpar.optimisation.spec import OptimiseSection, Variable
from swgpar.results.atomic import on_all, sentence
from swgpar.tasks import Send, share_tasks

if TYPE_CHECKING:
    import optuna

JOURNAL = "optimise.journal"
"""The embedded storage: a file to which every rank appends, also on network file systems."""

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
            raise OutputError(f"the storage {where} cannot be used: {sentence(error)}") from None

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

    where = url.rpartition("@")[2] or str(folder / JOURNAL)  # without a password
    first = _stored(comm, where, lambda: opened() if comm.rank == 0 else None)
    return _stored(comm, where, lambda: first or opened())


def _sampler(section: OptimiseSection, rank: int) -> optuna.samplers.BaseSampler:
    samplers, seed = import_optuna().samplers, section.seed + rank
    if section.sampler == "tpe":
        return samplers.TPESampler(seed=seed)
    return (
        samplers.NSGAIISampler(seed=seed)
        if section.sampler == "nsga2"
        else samplers.RandomSampler(seed=seed)
    )


def distribution(variable: Variable) -> optuna.distributions.BaseDistribution:
    """The values that a variable may take."""
    found = import_optuna().distributions
    if variable.choices:
        return found.CategoricalDistribution(variable.choices)
    if variable.integer:
        return found.IntDistribution(int(variable.low), int(variable.high), log=variable.log)
    return found.FloatDistribution(variable.low, variable.high, log=variable.log)


class Search:
    """One search in a storage, on all ranks of a communicator; collective unless said otherwise.

    Parameters
    ----------
    problem : Problem
    storage : of this rank
    name : of the search in the storage
    first : designs that are tried first, when the search is new
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
        sampler = _sampler(problem.section, comm.rank)
        _stored(
            comm,
            f"of {name}",
            lambda: self._create(storage, first, own) if comm.rank == 0 else None,
        )
        self.study = _stored(
            comm,
            f"of {name}",
            lambda: import_optuna().load_study(study_name=name, storage=storage, sampler=sampler),
        )

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
            for values in first:
                study.enqueue_trial(values)
        elif identity != problem.identity:
            raise InputError(
                f"the storage holds a search {self.name} of another problem: allowed are the same "
                f"variables, "
                "objectives, constraints, design and mesh, or overwrite = true (--overwrite)"
            )
        state = optuna.trial.TrialState
        for trial in study.get_trials(deepcopy=False, states=(state.RUNNING,)) if own else ():
            study.tell(trial.number, state=state.FAIL)  # interrupted: tried once more
            study.enqueue_trial(trial.params)

    def evaluations(self) -> dict[int, Evaluation]:
        """All that have ended, by number; not collective."""
        complete = import_optuna().trial.TrialState.COMPLETE
        trials = self.study.get_trials(deepcopy=False, states=(complete,))
        return {trial.number: _evaluation(trial) for trial in trials}

    def run(self, wanted: int, receive: Receive) -> None:
        """Try designs until `wanted` have ended. receive : called on rank 0"""
        left = self.comm.bcast(wanted - len(self.evaluations()) if self.comm.rank == 0 else None)
        if self.problem.section.parallel == "ranks":
            for _ in range(max(left, 0)):
                self._together(receive)
            return
        share_tasks(self.comm, max(left, 0), self._alone, receive)

    def _alone(self, _: int, send: Send) -> None:
        """Try one design on this rank."""
        trial = self.study.ask(self._distributions)
        found = self.problem.evaluate(trial.params, MPI.COMM_SELF)
        self._tell(trial, found)
        send((trial.number, found))

    def _together(self, receive: Receive) -> None:
        """Try one design on all ranks."""
        trial = self.study.ask(self._distributions) if self.comm.rank == 0 else None
        found = self.problem.evaluate(self.comm.bcast(trial.params if trial else None), self.comm)
        if trial:
            self._tell(trial, found)
            receive((trial.number, found))

    def _tell(self, trial: optuna.Trial, found: Evaluation) -> None:
        """Store an evaluation. A failed design is one of the worst values that violates a
        constraint."""
        for key in ("status", "reason", "quantities", "wall_s"):
            trial.set_user_attr(key, getattr(found, key))
        for text, amount in found.violations.items():
            trial.set_constraint(text, amount)
        values = []
        for objective in self.problem.section.objective:
            worst = float("inf") if objective.goal == "minimise" else -float("inf")
            values.append(found.quantities.get(objective.quantity, worst))
        self.study.tell(trial, values)

    def best(self) -> list[int]:
        """Numbers of the best feasible design, or of those of the Pareto front; not collective."""
        feasible = {
            number for number, found in self.evaluations().items() if found.status == "feasible"
        }
        if not feasible:
            return []
        if len(self.problem.section.objective) > 1:
            return [trial.number for trial in self.study.best_trials if trial.number in feasible]
        return self.ranked()[:1]

    def ranked(self) -> list[int]:
        """Numbers of the feasible designs by their first objective, the best one first; not
        collective."""
        objective = self.problem.section.objective[0]
        sign = 1.0 if objective.goal == "minimise" else -1.0
        found = {n: each for n, each in self.evaluations().items() if each.status == "feasible"}
        return sorted(found, key=lambda number: sign * found[number].quantities[objective.quantity])

    def importance(self) -> dict[str, dict[str, float]]:
        """Share of every variable in the best values of an objective, by PED-ANOVA; not collective.

        Empty with less than ten feasible designs, or one variable.
        """
        optuna = import_optuna()
        complete = optuna.trial.TrialState.COMPLETE
        trials = [
            trial
            for trial in self.study.get_trials(deepcopy=False, states=(complete,))
            if trial.user_attrs["status"] == "feasible"
        ]
        if len(trials) < 10 or len(self._distributions) < 2:
            return {}
        found = {}
        for index, objective in enumerate(self.problem.section.objective):
            direction = objective.goal.replace("ise", "ize")
            study = optuna.create_study(direction=direction)
            for trial in trials:
                study.add_trial(
                    optuna.trial.create_trial(
                        params=trial.params,
                        distributions=trial.distributions,
                        value=trial.values[index],
                    )
                )
            evaluator = optuna.importance.PedAnovaImportanceEvaluator()
            found[objective.quantity] = optuna.importance.get_param_importances(
                study, evaluator=evaluator
            )
        return found


def _evaluation(trial: optuna.trial.FrozenTrial) -> Evaluation:
    kept = trial.user_attrs
    return Evaluation(
        dict(trial.params),
        kept["status"],
        kept["reason"],
        kept["quantities"],
        dict(trial.constraints),
        kept["wall_s"],
    )
