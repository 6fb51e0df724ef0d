"""The laws that a design may choose by the key `type` of a section of a material."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from swgpar.input.quantities import default_type
from swgpar.materials.isotropic import Isotropic
from swgpar.materials.transversely_isotropic import TransverselyIsotropic

Law = Isotropic | TransverselyIsotropic
"""All laws, with | between them: docs/howto/own_material.md."""

_BY_TYPE = (Field(discriminator="type"), BeforeValidator(default_type("isotropic")))

ChosenMaterial = Annotated[Law, *_BY_TYPE]
"""A section of a material."""

OptionalMaterial = Annotated[Law | None, *_BY_TYPE]
"""A section of a material that falls back on [material]."""
