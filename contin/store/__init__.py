"""Results as files: JSON, the SQLite store, exports."""
