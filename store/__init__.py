"""What is remembered: records, blobs, events, settings. Shared by api and worker."""
