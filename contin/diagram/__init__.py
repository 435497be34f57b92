"""The explorer: which branch to follow next, identity of branches, the graph, the report."""
