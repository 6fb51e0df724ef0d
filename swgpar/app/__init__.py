"""The drive in the browser: keys, section of the teeth, runs of a workspace folder."""
