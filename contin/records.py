"""Names with values of several kinds: what YAML and JSON files hold, options that are passed on, coefficients by name.

What lies in them is checked where it is read (`contin.model.schema`, `contin.runs.schema`, `contin.store.validate`);
types for it further in would say less than the schemas do.
"""

from collections.abc import Mapping
from typing import Any, TypeAlias

Record: TypeAlias = Mapping[str, Any]  # read only
Fields: TypeAlias = dict[str, Any]
Json: TypeAlias = Any  # a document's value: number, text, true or false, null, list or mapping of these
Sympy: TypeAlias = Any  # an expression of sympy, which has no types
