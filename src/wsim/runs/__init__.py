"""One program through its passes (attempt, accept), the pipeline, its reruns, the folder of a run."""
