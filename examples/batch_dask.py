"""Runs a manifest of `formwork batch` on a Dask cluster, one task for each asset.

    python examples/batch_dask.py MANIFEST.json --scheduler tcp://HOST:8786
    python examples/batch_dask.py MANIFEST.json --local 2

The first uses a cluster that is there, the second starts workers on this machine. It needs
`pip install distributed`; every worker needs the program (--formwork, if it is not on the path) and the
folder of the manifest under the same name. Outputs and reports are those of `formwork batch`, and assets
that are up to date are not done again, however they were done. Exit code 1 if assets failed.
"""

import argparse
import json
import os
import subprocess
import sys

from distributed import Client, LocalCluster, as_completed


def one(formwork, manifest, i, n):
    """Asset i of n: a shard of its own. What went wrong, if anything did; the worker goes on."""
    command = [formwork, "batch", manifest, "--shard", f"{i}/{n}", "--json"]
    run = subprocess.run(command, capture_output=True, text=True)
    try:
        return json.loads(run.stdout)
    except json.JSONDecodeError:
        return {"done": 0, "unchanged": 0, "failed": 1, "failures": [{"error": run.stderr.strip()}]}


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("manifest")
    where = arguments.add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", help="address of a running cluster")
    where.add_argument("--local", type=int, metavar="N", help="N worker processes on this machine")
    arguments.add_argument("--formwork", default="formwork", help="the program")
    args = arguments.parse_args()
    manifest = os.path.abspath(args.manifest)
    with open(manifest) as file:
        n = len(json.load(file)["assets"])
    cluster = args.scheduler or LocalCluster(n_workers=args.local, threads_per_worker=1, dashboard_address=None)
    totals = {"assets": n, "done": 0, "unchanged": 0, "failed": 0, "failures": []}
    with Client(cluster) as client:
        tasks = [client.submit(one, args.formwork, manifest, i + 1, n, pure=False) for i in range(n)]
        for task in as_completed(tasks):
            # A task that its worker could not finish is an asset that failed.
            error = task.exception() if task.status == "error" else None
            said = {"failed": 1, "failures": [{"error": str(error)}]} if error else task.result()
            for key in totals:
                if key != "assets" and key in said:
                    totals[key] += said[key]
    print(json.dumps(totals))
    return 1 if totals["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
