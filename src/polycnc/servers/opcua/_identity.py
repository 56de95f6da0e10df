"""Who the server is and who may come in: its certificate, and the secret of its clients."""

from __future__ import annotations

import hmac
import os
import socket
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asyncua.crypto.cert_gen import (
    dump_private_key_as_pem,
    generate_private_key,
    generate_self_signed_app_certificate,
)
from asyncua.crypto.permission_rules import User, UserRole
from cryptography import x509
from cryptography.hazmat.primitives import serialization
from cryptography.x509.oid import ExtendedKeyUsageOID

from polycnc.errors import UsageError

_DAYS = 3650
_MOST_BYTES = 1 << 16
CERTIFICATE, KEY = "certificate.der", "key.pem"


def application_uri() -> str:
    """Return the name of this server among all."""
    return f"urn:{socket.gethostname()}:polycnc"


@dataclass(frozen=True, slots=True)
class Identity:
    """A certificate (DER) and its private key (PEM)."""

    certificate: bytes
    key: bytes


def identity_of(folder: Path | None) -> Identity:
    """Read the identity that is kept in a folder, or make one and keep it there; without a folder, make one.

    Raises:
        UsageError: What is there cannot be read, or the folder cannot be written.
    """
    if folder is None:
        return _made()
    paths = folder / CERTIFICATE, folder / KEY
    try:
        if any(path.exists() for path in paths):
            found = Identity(*(path.read_bytes()[:_MOST_BYTES] for path in paths))
            certificate = x509.load_der_x509_certificate(found.certificate)
            key = serialization.load_pem_private_key(found.key, None)
            if certificate.public_key() != key.public_key():
                raise ValueError("they do not belong together")
            return found
        made = _made()
        folder.mkdir(parents=True, exist_ok=True)
        for path, content in zip(paths, (made.certificate, made.key), strict=True):
            _write(path, content)
    except (OSError, ValueError, TypeError) as error:
        said = error.strerror if isinstance(error, OSError) else error
        raise UsageError(
            f"{folder}: no certificate and key can be kept there: {said}",
            hint=f"Remove {CERTIFICATE} and {KEY}, and new ones are made; clients have to trust them anew.",
        ) from None
    return made


def _write(path: Path, content: bytes) -> None:
    new = path.with_suffix(".new")
    with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
        file.write(content)
    new.replace(path)


def _made() -> Identity:
    key = generate_private_key()
    host = socket.gethostname()
    certificate = generate_self_signed_app_certificate(
        key,
        f"polycnc@{host}"[:64],
        {"organizationName": "polycnc"},
        [x509.UniformResourceIdentifier(application_uri()), x509.DNSName(host), x509.DNSName("localhost")],
        extended=[ExtendedKeyUsageOID.SERVER_AUTH],
        days=_DAYS,
    )
    return Identity(certificate.public_bytes(serialization.Encoding.DER), dump_private_key_as_pem(key))


class Users:
    """Let clients in: those who show the secret as their password, or everybody where there is none."""

    def __init__(self, token: str | None) -> None:
        self._token = token

    def get_user(
        self, iserver: Any, username: str | None = None, password: str | None = None, certificate: Any = None
    ) -> User | None:
        """Return the user; None for whoever is not let in."""
        if self._token is None:
            return User(role=UserRole.User)
        shown = password.decode("utf-8", "replace") if isinstance(password, bytes) else password or ""
        if hmac.compare_digest(shown.encode(), self._token.encode()):
            return User(role=UserRole.User, name=username)
        return None
