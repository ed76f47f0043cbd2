"""Runs a shipped case with a changed key and draws its design and its history."""
import sys

import flexmorph

case = flexmorph.load("short_beam", set={"design.max_volume": 0.5, "design.cell": 0.05,
                                         "design.min_thickness": 0.05, "optimizer.max_iterations": 40})
run = case.run()
print(run.status, run.designs["beam"].results["crisp_compliance"], "J")
run.designs["beam"].plot().figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "design.svg")
run.history.plot("compliance").figure.savefig(sys.argv[2] if len(sys.argv) > 2 else "history.svg")
