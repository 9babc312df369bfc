import time


def build(scene):
    time.sleep(1000)
