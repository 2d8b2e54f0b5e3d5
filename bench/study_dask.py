"""study_dask.py: what Dask costs a study per case, beside the same cases by this process. What is printed and how to read it:
README.md."""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


def timed(study, path, **how):
    """Seconds of the whole, and of the cases by themselves."""
    start = time.perf_counter()
    results = study.run(path, **how)
    whole = time.perf_counter() - start
    return whole, sum(row["seconds"] for row in results.table("cases"))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="?", type=int, default=2000)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.build / "python"))
    os.environ["PYTHONPATH"] = str(arguments.build / "python")
    import distributed
    import febiodea
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run([arguments.build / "samples/make_samples", "--spheres", "4", "ball.feb"], check=True)
        study = febiodea.Study(os.path.join(folder, "ball.feb"), {"tilt": f"rotate ball=0,1,0,{{1:{arguments.cases}:1}}"},
                               states="last", law="linear", facets="flat")
        with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client:
                print("            ms per case: all   solving   the rest")
                for turn in range(3):
                    for name, how in [("this process", {"workers": 1}), ("Dask", {"client": client})]:
                        whole, cases = (1e3 * s / len(study) for s in timed(study, f"{name}{turn}.db", **how))
                        print(f"{name:12s} {whole:17.3f} {cases:9.3f} {whole - cases:10.3f}", flush=True)


if __name__ == "__main__":
    main()
