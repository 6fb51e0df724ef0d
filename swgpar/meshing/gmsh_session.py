"""Gmsh for a few calls: started when it does not run, without settings' files and its signals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from swgpar import watch
from swgpar.errors import SwgparError
from swgpar.petsc import NO_FILES, hidden_variables


@contextmanager
def gmsh_model(name: str) -> Iterator[ModuleType]:
    """The module gmsh with a new model, which is removed at the end."""
    import gmsh  # here, so that runs on an existing mesh need no graphics libraries

    owner = not gmsh.isInitialized()
    if owner:
        # Gmsh has a PETSc of its own, which reads files and takes signals as the other. -v 0: no
        # warning that the option is not one of Gmsh
        arguments = ["gmsh", "-v", "0", NO_FILES]
        with hidden_variables():
            gmsh.initialize(argv=arguments, readConfigFiles=False, interruptible=False)
        watch.rearm()
    try:
        gmsh.option.setNumber("General.Verbosity", 5)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add(name)
        try:
            yield gmsh
        except Exception as error:
            if type(error) is not Exception:  # those of Gmsh have no class of their own
                raise
            text = " ".join(str(error).split())
            raise SwgparError(f"Gmsh cannot make {name}: {text}") from None
        finally:
            gmsh.model.remove()
    finally:
        if owner:
            gmsh.finalize()
