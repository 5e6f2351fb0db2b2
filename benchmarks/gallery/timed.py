# SPDX-License-Identifier: BSD-3-Clause
"""Runs a command and writes its wall and CPU time, its peak of memory and whether it succeeded as one line of JSON.

    python3 timed.py RESULT.json LIMIT COMMAND...    LIMIT [s of CPU time]: the command is ended then, or after three times
                                                     as long; its output goes to RESULT.log
"""
import json
import os
import resource
import signal
import subprocess
import sys
import time


def main():
    result, limit, command = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    begin = time.monotonic()
    with open(os.path.splitext(result)[0] + ".log", "w", encoding="utf-8") as log:
        child = subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(limit),) * 2))
        late = False
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - begin > 3 * limit and not late:
                late = True
                os.killpg(child.pid, signal.SIGKILL)
            time.sleep(0.02)
    late = late or os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL)
    state = "late" if late else "done" if status == 0 else "failed"
    with open(result, "w", encoding="utf-8") as file:
        json.dump({"state": state, "seconds": round(time.monotonic() - begin, 2), "mb": usage.ru_maxrss // 1024,
                   "cpu": round(usage.ru_utime + usage.ru_stime, 2)}, file)


main()
