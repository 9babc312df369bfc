"""What all searches share: words and their stems, words of one meaning, and a ranking in SQLite."""
