"""python_threads.py MODEL...: what two threads of one Python do, over what two processes do, both in turns in one run.

Needs the build tree that holds it, or --build FOLDER. What is printed and how to read it: README.md."""
import argparse
import pathlib
import statistics
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


def serve(model, law):
    """Answers each line "analyse|press THREADS COUNT": that many threads have done so many calls each."""
    import febiodea
    recognition = febiodea.recognise(model, law=law)
    joint = febiodea.prepare(recognition)
    poses = joint.press(joint.solve()).poses
    works = {"analyse": lambda: febiodea.analyse(recognition), "press": lambda: joint.press(poses)}
    print("ready", flush=True)
    for line in sys.stdin:
        name, threads, count = line.split()

        def work():
            for _ in range(int(count)):
                works[name]()
        all_threads = [threading.Thread(target=work) for _ in range(int(threads))]
        for thread in all_threads:
            thread.start()
        for thread in all_threads:
            thread.join()
        print("done", flush=True)


def seconds(servers, name, threads, count):
    start = time.perf_counter()
    for server in servers:
        server.stdin.write(f"{name} {threads} {count}\n")
        server.stdin.flush()
    for server in servers:
        if server.stdout.readline() != "done\n":
            sys.exit("a process ended early")
    return time.perf_counter() - start


def measure(build, model, law, rounds):
    servers = [subprocess.Popen([sys.executable, __file__, "--serve", law, "--build", build, model], stdin=subprocess.PIPE,
                                stdout=subprocess.PIPE, text=True) for _ in range(3)]
    for server in servers:
        if server.stdout.readline() != "ready\n":
            sys.exit(f"{model}: cannot be solved")
    one, two = servers[:1], servers[1:]
    for name in ("analyse", "press"):
        for server in servers:
            seconds([server], name, 2, 1)
        count = max(1, round(0.5 / (seconds(one, name, 1, 4) / 4)))
        alone, threads, processes = [], [], []
        for k in range(rounds):
            turns = [(alone, one, 1), (threads, one, 2), (processes, two, 1)]
            for place in range(3):  # each comes first as often
                times, who, how_many = turns[(place + k) % 3]
                times.append(seconds(who, name, how_many, count))
        shares = [p / t for p, t in zip(processes, threads)]
        print(f"{pathlib.Path(model).name:20} {law:7} {name:8} {count / min(alone):9.1f} {2 * count / min(processes):10.1f} "
              f"{2 * count / min(threads):9.1f} {min(processes) / min(threads):7.3f} {statistics.median(shares):7.3f}",
              flush=True)
    for server in servers:
        server.stdin.close()
        server.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--serve", metavar="LAW", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    sys.path.insert(0, str(asked.build / "python"))
    if asked.serve:
        serve(asked.models[0], asked.serve)
        return
    print(f"{'model':20} {'law':7} {'calls':8} {'alone /s':>9} {'2 proc. /s':>10} {'2 thr. /s':>9} {'least':>7} {'median':>7}")
    for model in asked.models:
        for law in ("linear", "layer"):
            measure(asked.build, model, law, asked.rounds)


if __name__ == "__main__":
    main()
