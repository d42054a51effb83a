"""Every topic of the rig into one Rerun recording. Nobody waits for it; only this service imports rerun."""
