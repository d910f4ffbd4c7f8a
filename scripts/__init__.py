"""Command-line entry points, one short file a job."""
