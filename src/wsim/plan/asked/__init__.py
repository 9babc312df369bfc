"""What a prompt asks for, word by word, and which of it a plan answers for; no model takes part."""
