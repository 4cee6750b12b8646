"""Client of the Integument mesh server: a typed Python library and the `integument` command."""

from integument.client import Client
from integument.cohort import Cohort
from integument.embedded import EmbeddedServer
from integument.errors import (
    ArgumentError,
    DownloadCorruptError,
    EmbeddedServerError,
    IntegumentError,
    JobDismissedError,
    JobError,
    JobFailedError,
    ProblemError,
    ReplyError,
    ServerError,
    ServerNotInstalledError,
    ServerStartError,
    ServerUnreachableError,
    WaitTimeoutError,
)
from integument.event import JobEvent
from integument.job import Failure, Job
from integument.mesh import Mesh
from integument.problem import Problem
from integument.process import Process
from integument.region import Region
from integument.report import (
    ComparisonNumbers,
    DeviationNumbers,
    Finding,
    MeshNumbers,
    PairNumbers,
    Report,
    StepNumbers,
    ThicknessNumbers,
)
from integument.result import Output, Results

__all__ = [
    "ArgumentError",
    "Client",
    "Cohort",
    "ComparisonNumbers",
    "DeviationNumbers",
    "DownloadCorruptError",
    "EmbeddedServer",
    "EmbeddedServerError",
    "Failure",
    "Finding",
    "IntegumentError",
    "Job",
    "JobDismissedError",
    "JobError",
    "JobEvent",
    "JobFailedError",
    "Mesh",
    "MeshNumbers",
    "Output",
    "PairNumbers",
    "Problem",
    "ProblemError",
    "Process",
    "Region",
    "ReplyError",
    "Report",
    "Results",
    "ServerError",
    "ServerNotInstalledError",
    "ServerStartError",
    "ServerUnreachableError",
    "StepNumbers",
    "ThicknessNumbers",
    "WaitTimeoutError",
]
