"""Load on a real server on loopback: how fast it accepts, works, tells, takes files in and lets go, and what that costs."""
