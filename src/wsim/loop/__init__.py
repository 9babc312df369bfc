"""The loop: a sentence becomes a judged world (`generate`), and a recorded run is made again (`replay`)."""
