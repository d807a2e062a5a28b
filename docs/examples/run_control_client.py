# SPDX-License-Identifier: GPL-3.0-or-later
"""Client of `todbench serve`, with the standard library only: python3 run_control_client.py URL TOKEN PLAN.toml [SEED]"""
import json
import sys
import urllib.request


class Bench:
    def __init__(self, url, token):
        self.url, self.token = url.rstrip("/") + "/api/v1/", token

    def open(self, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        headers = {"Authorization": "Bearer " + self.token, "Content-Type": "application/json"}
        return urllib.request.urlopen(urllib.request.Request(self.url + path, data, headers), timeout=60)

    def get(self, path):
        return json.load(self.open(path))

    def post(self, path, body=None):
        return json.load(self.open(path, body or {}))

    def states(self, run):
        """States of a run, until it is over."""
        for line in self.open(f"runs/{run}/events"):
            if line.startswith(b"data: "):
                yield json.loads(line[6:])

    def run(self, plan_toml, answer=lambda steps: "done", **more):
        """Runs a plan and returns its last state; `answer` answers the requests to the operator."""
        run, answered = self.post("runs", {"plan_toml": plan_toml, **more})["id"], 0
        for state in self.states(run):
            question = state["question"]
            if question and question["number"] > answered:
                answered = question["number"]
                self.post(f"runs/{run}/answer", {"answer": answer(question["steps"]), "number": answered})
        return state


if __name__ == "__main__":
    seed = {"seed": int(sys.argv[4])} if len(sys.argv) > 4 else {}
    bench = Bench(*sys.argv[1:3])
    last = bench.run(open(sys.argv[3], encoding="utf-8").read(), **seed)
    print(last["state"], last["verdict"], last["reason"] or last["session"])
    sys.exit(last["exit_code"])
