"""What is asked for: run files, cases, studies."""
