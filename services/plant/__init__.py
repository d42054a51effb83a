"""The machine at its electrical boundary: hydraulics, links, contact, sensors; and the gate before its valves."""
