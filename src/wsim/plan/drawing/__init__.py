"""Two drawings of a laid-out plan, from above and from the side: as text for a terminal, and as a picture.

`draw_text` is in `text`, `draw_picture` in `picture`, which loads Pillow.
"""
