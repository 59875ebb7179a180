"""Time-domain dynamics of the slider-crank and the engine crank train.

>>> import crankmbs
>>> result = crankmbs.simulate(crankmbs.load_scene("yi_diesel"))

A name is imported when it is first used, from where the stub beside this file has it.
"""

import lazy_loader as _lazy_loader

_public, __dir__, __all__ = _lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib import metadata

        return metadata.version("crankmbs")
    return _public(name)
