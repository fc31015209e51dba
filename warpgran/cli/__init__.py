"""The command line: a file per command or group of small commands, and what they share."""
