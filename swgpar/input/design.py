"""A design: the checked content of a design file, from which changed designs are made."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import PrivateAttr

from swgpar.input.quantities import Section
from swgpar.input.toml_file import FILE_KEYS, Overrides, apply_overrides, flat


class Design(Section):
    """The content of a design file. Attributes are its sections; a design never changes.

    system : section by which files of its kind are recognised, a key of `swgpar.systems.SYSTEMS`
    """

    system: ClassVar[str]

    _maker: Callable[[dict[str, Any]], Self] = PrivateAttr()

    def made_by(self, maker: Callable[[dict[str, Any]], Self]) -> Self:
        """This design, which `maker` has checked: designs that are made of it are checked in the
        same way."""
        self._maker = maker
        return self

    @property
    def files(self) -> list[Path]:
        """Files that the design is made of, beside its own."""
        return [
            Path(value)
            for key, value in flat(self.model_dump())
            if key.split(".")[-1] in FILE_KEYS and isinstance(value, str)
        ]

    def with_values(self, values: Overrides) -> Self:
        """A new, checked design with other values.

        Parameters
        ----------
        values : mapping, or sequence of str
            ``"section.key"`` -> value, in the units of the design file; a whole section is given as
            a dict.

        Raises
        ------
        InputError
            An unknown key, or a value that is out of range or does not fit the others.

        Examples
        --------
        >>> lighter = design.with_values({"load.torque": 5.0, "steps.rotation": 10.0})
        """
        return self._maker(apply_overrides(self.model_dump(exclude_unset=True), values))
