"""Ray: what is no Ray, two nodes, killed processes, and no port that others reach."""

import subprocess
import sys
from importlib.util import find_spec

import pytest
from scripts import SUICIDE, once, told_by

from flatrig.training.jobs import BackendError
from flatrig.training.jobs.on_ray import GREETING, Ray

needs_ray = pytest.mark.skipif(not find_spec("ray"), reason="ray is not installed (extra ray)")

ASKED = """
import socket, sys
with socket.create_server(("127.0.0.1", 0)) as server:
    print(server.getsockname()[1], flush=True)
    connection, _ = server.accept()
    connection.sendall(sys.argv[1].encode())
    connection.recv(100)
"""


@needs_ray
def test_a_port_in_use_by_another_program_is_no_ray(monkeypatch):
    words = [sys.executable, "-c", ASKED, "HTTP/1.1 400 Bad Request"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as other:
        port = int(other.stdout.readline())
        monkeypatch.setenv("RAY_ADDRESS", f"127.0.0.1:{port}")
        with pytest.raises(BackendError, match="is no Ray; another has that port"):
            list(Ray()(eval, {0: "0"}, 0))
        other.kill()
    with pytest.raises(BackendError, match=f"nothing answers at RAY_ADDRESS=127.0.0.1:{port}"):
        list(Ray()(eval, {0: "0"}, 0))


def test_the_greeting_is_that_of_http_2():
    assert GREETING.startswith(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")
    assert len(GREETING) == 24 + 9


NODES = """
import os, sys
from pathlib import Path
from flatrig.training.jobs import Jobs
from flatrig.training.jobs.on_ray import LOOPBACK_ONLY, Ray

os.environ |= LOOPBACK_ONLY
from ray.cluster_utils import Cluster

node = {"num_cpus": 1, "node_ip_address": "127.0.0.1", "object_store_memory": 80 * 2**20}
cluster = Cluster(initialize_head=True, head_node_args=node | {"include_dashboard": False})
cluster.add_node(**node)
os.environ["RAY_ADDRESS"] = cluster.address
where = "(__import__('time').sleep(0.2), __import__('ray').get_runtime_context().get_node_id())[1]"
guilty, once = sys.argv[1:]
items = [where] * 4 + [guilty, once] + [where] * 4
results = sorted(Jobs(eval, Ray(), file=Path("progress.jsonl")).results(items),
                 key=lambda result: result.number)
print("nodes", len({r.ending for r in results if r.number not in (4, 5)}))
print("guilty", type(results[4].failure).__name__, results[5].value)
cluster.shutdown()
"""

# Listening sockets are looked up in the system's own tables, of all processes that were begun here.
ALONE = """
import os
from flatrig.training.jobs import Jobs
from flatrig.training.jobs.on_ray import Ray

def begun_here():
    parents = {}
    for pid in filter(str.isdecimal, os.listdir("/proc")):
        try:
            parents[pid] = open(f"/proc/{pid}/stat").read().rpartition(")")[2].split()[1]
        except OSError:  # it has just ended
            pass
    ours = {str(os.getpid())}
    while more := {pid for pid in parents if parents[pid] in ours and pid not in ours}:
        ours |= more
    return ours

def listening():
    inodes = {}
    for table in ("tcp", "tcp6"):
        for line in open(f"/proc/net/{table}").readlines()[1:]:
            fields = line.split()
            if fields[3] == "0A":
                inodes[f"socket:[{fields[9]}]"] = fields[1].partition(":")[0]
    links = set()
    for pid in begun_here():
        try:
            links |= {os.readlink(f"/proc/{pid}/fd/{fd}") for fd in os.listdir(f"/proc/{pid}/fd")}
        except OSError:
            pass
    return {inodes[link] for link in links if link in inodes}

token = "__import__('os').environ['RAY_AUTH_MODE']"
results = Jobs(eval, Ray(2)).results(["0", token, "2"])
first = next(results)
print(*sorted(listening()))
print(sorted(str(result.value) for result in [first, *results]))
"""


@needs_ray
def test_two_nodes_of_ray_share_the_work_and_lose_nothing_with_a_process(tmp_path):
    said = told_by(NODES, tmp_path, SUICIDE, once(tmp_path / "dead"))
    assert said == ["nodes 2", "guilty JobError True"]
    assert len((tmp_path / "progress.jsonl").read_text().splitlines()) == 10


@needs_ray
@pytest.mark.skipif(sys.platform != "linux", reason="sockets are looked up in /proc")
def test_ray_that_is_begun_here_listens_on_the_loopback_address_only(tmp_path):
    addresses, values = told_by(ALONE, tmp_path)
    loopback = "0100007F"  # 127.0.0.1 as /proc has it, and as IPv6
    mapped = f"0000000000000000FFFF0000{loopback}"
    assert set(addresses.split()) == {loopback, mapped}
    assert values == "['0', '2', 'token']"
