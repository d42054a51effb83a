"""Every topic of a cell into one Rerun recording. The recorder only listens, so it never blocks the control loop."""
