"""The loop: a sentence becomes a judged world, and a recorded run is made again."""
