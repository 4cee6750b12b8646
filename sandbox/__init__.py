"""Untrusted work in limited child processes: a warm fork server, limits, messages. Linux only; knows no queue and no web."""
