"""A live cell, a fault in the middle of a trial, and the report of the trip that it causes.

    python examples/break_it_live.py

Plant, controller, supervisor and recorder start as processes of this program and end with it. The force gauge sticks after
one second of the trial; the supervisor must notice that its noise is gone, and the valves must close.
"""

import hydrohil as hh


def main(name: str = "example", port: int = 7850) -> hh.Run:
    """Run, break, read why it tripped, reset; then the same trial without the fault."""
    experiment = hh.load("fig-5-5")
    broken = experiment.with_faults("stuck force at=1.0 for=2.0")
    with hh.Cell(name, port) as cell:
        run = cell.run(broken, clock="lockstep", note=print)
        print(run)
        report = run.trip_report
        assert report is not None, "a gauge that sticks must trip the rig"
        print(report["sentence"])
        print(f"  what must hold: {report['must_hold']}")
        print(f"  what to do:     {report['to_do']}")
        force_counts = report["signals"]["plant/sample"]["force_counts"]
        print(f"  the last readings: {force_counts[-8:]} counts")

        print("mode:", cell.status()["supervisor"]["mode"])
        cell.reset()
        return cell.run(experiment, clock="lockstep", progress=lambda trial_s: print(f"\r{trial_s:6.1f} s", end=""))


if __name__ == "__main__":
    print("\n", main())
