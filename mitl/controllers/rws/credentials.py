"""User and password of a controller: from the environment or the keyring, never from a file, never shown.

Invariant: a Credentials object never prints its password.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field

from mitl.errors import UsageError

USER_VARIABLE, PASSWORD_VARIABLE = "MITL_RWS_USER", "MITL_RWS_PASSWORD"
DEFAULT_USER = "Default User"
_SERVICE = "mitl"


@dataclass(frozen=True)
class Credentials:
    """A user with a password."""

    user: str
    password: str = field(repr=False)


def find_credentials(host: str, environment: Mapping[str, str] = os.environ) -> Credentials:
    """Gives the credentials for a host: MITL_RWS_USER and MITL_RWS_PASSWORD, else the keyring's entry `mitl` for `USER@HOST`.

    Raises UsageError saying both ways where there are none.
    """
    user = environment.get(USER_VARIABLE, DEFAULT_USER)
    password = environment.get(PASSWORD_VARIABLE)
    if password is None:
        password = _from_keyring(f"{user}@{host}")
    if password is None:
        raise UsageError(
            f"no password for {user!r} at {host}: set {PASSWORD_VARIABLE} (and {USER_VARIABLE}), "
            f"or keep it in the keyring: keyring set {_SERVICE} '{user}@{host}'"
        )
    return Credentials(user, password)


def _from_keyring(name: str) -> str | None:
    try:
        keyring = importlib.import_module("keyring")
    except ImportError:
        return None
    try:
        found = keyring.get_password(_SERVICE, name)
    except keyring.errors.KeyringError as error:  # locked, or there is none on this computer
        raise UsageError(f"the keyring cannot be read ({error}): set {USER_VARIABLE} and {PASSWORD_VARIABLE} instead") from error
    return found if isinstance(found, str) else None
