"""How a client finds its service: not through a proxy where the service is on this machine."""

from __future__ import annotations

import pytest

import becalm
from becalm.client import _ServiceAddress

PROXIES = ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy")


@pytest.fixture
def proxied(monkeypatch, request):
    for name in PROXIES:
        monkeypatch.setenv(name, request.param)
    for name in ("NO_PROXY", "no_proxy"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize(
    ("address", "here"),
    [
        ("http://127.0.0.1:8000", True),
        ("http://127.0.0.2:8000", True),
        ("http://localhost:8000/becalm", True),
        ("http://LOCALHOST", True),
        ("http://[::1]:8000", True),
        ("http://robot-lab:8000", False),
        ("http://10.0.0.1", False),
        ("http://localhost.example", False),
    ],
)
def test_a_service_on_this_machine(address, here):
    assert _ServiceAddress(address, None).is_here is here


@pytest.mark.parametrize("proxied", ["http://127.0.0.1:9", "socks5://127.0.0.1:9", "rubbish"], indirect=True)
@pytest.mark.usefixtures("proxied")
def test_no_proxy_leads_to_this_machine():
    """The address is that of nobody: the answer is that, and nothing about a proxy."""
    with becalm.Client("http://127.0.0.1:9") as client:
        with pytest.raises(becalm.ServiceUnreachable, match=r"127\.0\.0\.1:9"):
            client.health()
        with pytest.raises(becalm.ServiceUnreachable, match=r"127\.0\.0\.1:9"):
            next(client.watch())


@pytest.mark.parametrize("proxied", ["socks5://127.0.0.1:9", "rubbish://x"], indirect=True)
@pytest.mark.usefixtures("proxied")
def test_a_proxy_that_cannot_be_used_is_told_as_such():
    for kind in (becalm.Client, becalm.AsyncClient):
        with pytest.raises(becalm.ProxyUnusable) as refused:
            kind("http://robot-lab.example:8000")
        assert "NO_PROXY" in refused.value.tip
