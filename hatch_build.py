"""Build hook: the repository's `models/` goes into wheels as `contin/_models`.

An editable install gets no copy: it reads the folder in the repository, so an edited model is seen at once.
"""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class BundleModels(BuildHookInterface[Any]):
    """Adds the bundled models to a standard wheel and leaves an editable one alone."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if self.target_name == "wheel" and version == "standard":
            build_data["force_include"]["models"] = "contin/_models"
