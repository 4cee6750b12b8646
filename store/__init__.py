"""What outlives a process: settings, the job table, meshes, blobs, events.

Shared by `api` and `worker`; knows nothing of HTTP.
"""
