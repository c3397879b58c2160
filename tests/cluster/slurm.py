"""A SLURM of one node for a test: munge, controller, node, as this user, on loopback, in its own folder."""

import getpass
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "sinfo", "scontrol")
_START_S = 60.0
_CONF = """
ClusterName=opml
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
MinJobAge=3600
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=8000 State=UNKNOWN
PartitionName=debug Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> list[str]:
    """Programs of SLURM that are not installed; Debian has them in slurm-wlm and munge."""
    return [name for name in NEEDED if _program(name) is None]


class Slurm:
    """A context in which `environment` lets sbatch and the like reach a running SLURM."""

    def __init__(self, folder: Path, *, cores: int = 2):
        self.folder, self._daemons = folder, []
        for name in ("state", "spool"):
            (folder / name).mkdir()
        folder.chmod(0o755)
        self._conf = folder / "slurm.conf"
        self._conf.write_text(
            _CONF.format(
                folder=folder,
                host=socket.gethostname().split(".")[0],
                user=getpass.getuser(),
                cores=cores,
                controller=_free_port(),
                node=_free_port(),
            )
        )
        self.environment = os.environ | {"SLURM_CONF": str(self._conf)}
        self.environment["PATH"] = os.pathsep.join([str(self._own_srun()), os.environ["PATH"]])

    def __enter__(self):
        try:
            self._start_munge()
            self._start("slurmctld", "-D", "-f", self._conf)
            self._start("slurmd", "-D", "-f", self._conf)
            self._await(self._is_idle, "an idle node")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        # The last started goes first. Only processes that this object started are ended.
        for daemon in reversed(self._daemons):
            daemon.terminate()
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def _own_srun(self):
        """Folder of an srun that knows the configuration: Snakemake's job steps drop SLURM_CONF."""
        path = self.folder / "bin" / "srun"
        path.parent.mkdir()
        path.write_text(f'#!/bin/sh\nSLURM_CONF="{self._conf}" exec "{_program("srun")}" "$@"\n')
        path.chmod(0o755)
        return path.parent

    def _start_munge(self):
        key, socket_ = self.folder / "munge.key", self.folder / "munge.socket"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self._start(
            "munged",
            "--foreground",
            "--force",
            *(f"--{name}={self.folder / file}" for name, file in _MUNGE_FILES.items()),
        )
        self._await(socket_.exists, "munge's socket")

    def _start(self, name, *arguments):
        log = (self.folder / f"{name}.out").open("wb")
        command = [_program(name), *map(str, arguments)]
        with log:
            self._daemons.append(
                subprocess.Popen(command, env=self.environment, stdout=log, stderr=subprocess.STDOUT)
            )

    def _is_idle(self):
        asked = subprocess.run(
            ["sinfo", "--noheader", "--format=%T"], env=self.environment, capture_output=True, text=True
        )
        return asked.stdout.strip() == "idle"

    def _await(self, ready, what):
        end = time.monotonic() + _START_S
        while not ready():
            if time.monotonic() > end or any(daemon.poll() is not None for daemon in self._daemons):
                logs = "\n".join(path.read_text(errors="replace") for path in self.folder.glob("*.out"))
                raise RuntimeError(f"SLURM: expected {what}, got none in {_START_S:g} s\n{logs}")
            time.sleep(0.5)


_MUNGE_FILES = {
    "key-file": "munge.key",
    "socket": "munge.socket",
    "pid-file": "munge.pid",
    "log-file": "munge.log",
    "seed-file": "munge.seed",
}


def _program(name: str) -> str | None:
    """Path of a program; daemons lie where an ordinary user's PATH does not look."""
    return shutil.which(name, path=os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"]))


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
