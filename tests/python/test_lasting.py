"""Long use: memory, threads, Ctrl-C."""
import gc
import multiprocessing
import os
import pathlib
import resource
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import febiodea


def resident():
    """Bytes of memory in use."""
    gc.collect()
    with open("/proc/self/statm") as f:
        return int(f.read().split()[1]) * resource.getpagesize()


def test_memory_is_flat_over_10000_presses(small):
    joint = febiodea.prepare(small)
    pose = np.eye(4)
    pose[2, 3] = -0.01

    def press(times):
        for _ in range(times):
            joint.press({joint.bodies[0]: pose}).contact().springs.pressure.sum()
    press(2000)  # caches fill
    before = resident()
    press(10000)
    assert resident() - before < 4e6  # a leak of one array would be a hundred times as much


def test_1000_results_leak_nothing(small):
    def analyse(times):
        for _ in range(times):
            result = febiodea.analyse(small, "last")
            held = result.states[-1].contact()
            assert held.springs.pressure.size and held.statistics and held.facets.pressure.size
    analyse(200)
    before = resident()
    analyse(1000)
    assert resident() - before < 8e6  # one result kept in ten would be more


def test_threads_side_by_side_give_the_same_bits(hip, models):
    knee = febiodea.recognise(models("plateaus/plateaus.feb"))
    joints = [hip, knee]

    def numbers(recognition):
        state = febiodea.analyse(recognition, "last").states[-1]
        return [c.springs.pressure.tobytes() for c in state.contacts] + [p.tobytes() for p in state.poses.values()]
    one_by_one = [numbers(j) for j in joints]
    found = [None] * 4

    def work(k):
        found[k] = numbers(joints[k % 2])
    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    ticks = 0  # this thread goes on meanwhile
    while any(thread.is_alive() for thread in threads):
        time.sleep(0.005)
        ticks += 1
    assert found == one_by_one + one_by_one and ticks > 5


def test_one_prepared_joint_for_several_threads(small):
    joint = febiodea.prepare(small)
    poses = []
    for k in range(40):
        pose = np.eye(4)
        pose[2, 3] = -0.001 * k
        poses.append({joint.bodies[0]: pose})
    alone = [joint.press(p).contact().force.tobytes() for p in poses]
    found = {}

    def work(first):
        for k in range(first, 40, 4):
            found[k] = joint.press(poses[k]).contact().force.tobytes()
    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[k] for k in range(40)] == alone


HIP = """
import os
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # one thread: processor time is the time that it takes
import febiodea, sys, time
recognition = febiodea.recognise(sys.argv[1], refine=4)
def tell(p):
    print(p.stage, flush=True)
print("begin", flush=True)
try:
    febiodea.analyse(recognition, progress=tell)
except KeyboardInterrupt:
    print("interrupted", time.process_time(), flush=True)
    if sys.argv[2] == "raise":
        raise
    print("went on", flush=True)
"""


def processor_time(process):
    """Seconds that a running process, with all its threads, has taken so far."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def processor_time_of_ended():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def interrupt(path, stage, then):
    """Seconds from the signal, to a process that is at `stage`, to its KeyboardInterrupt and to its end; its exit code and
    last words. The seconds are processor time, since others may keep the machine busy, or a tenth of the clock's."""
    before = processor_time_of_ended()
    process = subprocess.Popen([sys.executable, "-c", HIP, path, then], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    for line in process.stdout:
        if line.strip() == stage:
            break
    time.sleep(0.2)
    worked, start = processor_time(process), time.monotonic()
    process.send_signal(signal.SIGINT)

    def since(processor):
        return max(processor - worked, (time.monotonic() - start) / 10)

    raised = None
    for line in process.stdout:
        if line.startswith("interrupted"):
            raised = since(float(line.split()[1]))
            break
    out, err = process.stdout.read(), process.stderr.read()
    process.wait(60)
    return raised, since(processor_time_of_ended() - before), process.returncode, out, err


def test_interrupt_ends_an_analysis_within_a_second(samples):
    path = str(samples / "hip/hip_walking.feb")
    for stage in ("springs", "state"):
        raised, ended, code, _, err = interrupt(path, stage, "raise")
        assert raised is not None and raised < 1 and ended < 2, (stage, raised, ended, err)
        assert code == -signal.SIGINT and err.strip().endswith("KeyboardInterrupt")


def test_a_program_that_catches_the_interrupt_ends_in_order(samples):
    raised, _, code, out, err = interrupt(str(samples / "hip/hip_walking.feb"), "springs", "go on")
    assert raised is not None and raised < 1 and code == 0 and "went on" in out and err == ""


def pool_of_processes(hip):
    return febiodea.analyse(hip, "last").states[-1].contact().headline


@pytest.mark.parametrize("how", ["fork", "spawn"])
def test_processes_of_a_pool(hip, hip_result, how):
    expected = hip_result.states[-1].contact().headline
    with multiprocessing.get_context(how).Pool(2) as pool:
        assert pool.map(pool_of_processes, [hip, hip, hip]) == [expected] * 3


def test_a_forked_process_works_on_its_own(small):
    joint = febiodea.prepare(small)
    force = joint.press().contact().force.tobytes()
    child = os.fork()
    if child == 0:  # no thread of its parent goes on there
        os._exit(0 if joint.press().contact().force.tobytes() == force else 1)
    assert os.waitpid(child, 0)[1] == 0
