class Nasty(Exception):
    def __str__(self):
        raise self


def build(scene):
    raise Nasty
