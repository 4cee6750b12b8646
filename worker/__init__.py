"""Takes jobs off the queue and supervises the child process that does each; Celery and the job table meet here."""
