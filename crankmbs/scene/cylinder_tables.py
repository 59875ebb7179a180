"""A table for each cylinder: `[[cylinder]]`, as a file writes them.

Each table is an entry of `layout.cylinders`, and its pressures are entries of those of `[gas]`.
"""

from __future__ import annotations

from typing import Any

from crankmbs.errors import InputError

__all__ = ["by_layout"]

_PRESSURES = ("pressure", "motored", "crank_end")


def by_layout(raw: dict[str, Any]) -> dict[str, Any]:
    """What a file says, its cylinders moved to `layout` and `gas`; another file as it is.

    Raises
    ------
    InputError : cylinders given twice, or a pressure that one of them lacks

    >>> by_layout({"cylinder": [{"bank": "0 deg"}]})
    {'layout': {'cylinders': [{'bank': '0 deg'}]}}
    """
    cylinders = raw.get("cylinder")
    if cylinders is None:
        return raw
    if not isinstance(cylinders, list) or not all(isinstance(table, dict) for table in cylinders):
        raise InputError("cylinder: must be tables, [[cylinder]], one for each")
    content = {key: value for key, value in raw.items() if key != "cylinder"}
    layout = dict(content.get("layout") or {})
    twice = [key for key in ("cylinders", "firing_order") if key in layout]
    if twice:
        raise InputError(
            f"layout.{twice[0]}: beside [[cylinder]], whose phase and bank say the same; remove it"
        )
    gas = content.get("gas")
    keys = [key for key in _PRESSURES if any(key in table for table in cylinders)]
    if keys and not isinstance(gas, dict):
        raise InputError(
            f"cylinder: {keys[0]} needs [gas], with ambient and stroke; it is not there"
        )
    if isinstance(gas, dict):
        content["gas"] = gas | {key: _each(key, cylinders, gas) for key in keys}
    bare = [{k: v for k, v in table.items() if k not in _PRESSURES} for table in cylinders]
    content["layout"] = layout | {"cylinders": bare}
    return content


def _each(key: str, cylinders: list[dict[str, Any]], gas: dict[str, Any]) -> list[Any]:
    """A pressure of every cylinder: as its table has it, that of all, or none."""
    outside = gas.get("ambient", "0 Pa") if gas.get("absolute", True) else "0 Pa"
    pressures = []
    for number, cylinder in enumerate(cylinders, start=1):
        value = cylinder.get(key, gas.get(key))
        if value is None or isinstance(value, list | dict):
            raise InputError(
                f'cylinder[{number}].{key}: this key is missing; give a file, a pressure, or "none"'
            )
        pressures.append(outside if value == "none" else value)
    return pressures
