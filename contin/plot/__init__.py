"""Pictures: series (pure data) drawn by matplotlib, or by a small viewer in a self-contained HTML file."""
