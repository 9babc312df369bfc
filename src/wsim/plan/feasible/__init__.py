"""Whether a plan can come true: what contradicts itself, the start or what there is, told before anything is built."""
