"""Celery only: claim a job, supervise its child process, record what came of it."""
