"""The Kubernetes profile: a dry run, and the job as the executor renders it, checked against Kubernetes' own schema."""

import os
import shutil
import subprocess
import sys

import kubernetes_validate
import pytest
from kubernetes_api import kubernetes_api
from scratch_project import copy_project

pytestmark = pytest.mark.publish
PROFILE = ("--profile", "workflow/profiles/kubernetes", "--default-storage-prefix")


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """The project as a git checkout, from which the executor takes what it sends to the pods."""
    assert shutil.which("rsync"), "rsync not found, with which sources are stored; on Debian: apt-get install rsync"
    project = copy_project(tmp_path_factory.mktemp("kubernetes"))
    for command in (["git", "init", "--quiet"], ["git", "add", "."]):
        subprocess.run(command, cwd=project.folder, check=True)
    return project


def call(project, api, *options):
    kubeconfig = api.write_kubeconfig(project.folder / "kubeconfig")
    return subprocess.run(
        [sys.executable, "-m", "snakemake", *PROFILE, str(project.folder), *options],
        cwd=project.folder,
        env={**os.environ, "KUBECONFIG": str(kubeconfig), "NO_PROXY": "127.0.0.1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_a_dry_run_plans_every_job(project):
    with kubernetes_api() as api:
        done = call(project, api, "--dry-run")
    assert done.returncode == 0, done.stderr[-3000:]
    assert "simulate_wear" in done.stdout + done.stderr
    assert api.jobs == []


def test_the_rendered_job_is_valid_and_asks_for_what_the_profile_says(project):
    with kubernetes_api() as api:
        call(project, api, "--retries", "0", "--seconds-between-status-checks", "1", "--forcerun", "fit_normal_model")
    assert api.jobs
    for job in api.jobs:
        # The executor leaves these two to the client of the API, which puts them into the address.
        kubernetes_validate.validate({"apiVersion": "batch/v1", "kind": "Job", **job}, "1.30", strict=True)
        pod = job["spec"]["template"]["spec"]
        (container,) = pod["containers"]
        assert container["image"] == "jointwear:0.1.0"
        assert {"name": "jointwear", "mountPath": "/jointwear"} in container["volumeMounts"]
        assert {"name": "jointwear", "persistentVolumeClaim": {"claimName": "jointwear"}} in pod["volumes"]
        assert int(container["resources"]["requests"]["memory"].removesuffix("M")) >= 500
        assert "snakemake" in container["args"][1]
