"""A table built by nested helpers, lambdas and *args."""
from functools import partial
from wsim.scene import Scene

def mirrored(f, *args, **kwargs):
    return [f(sx, sy, *args, **kwargs) for sx in (-1, 1) for sy in (-1, 1)]

def build(scene: Scene) -> None:
    scene.ground()
    width, depth, height, t = 1.2, 0.7, 0.72, 0.03
    static_box = partial(scene.box, static=True, color=(0.4, 0.25, 0.1))
    corner = lambda s, extent: s * (extent / 2 - 0.04)

    def leg(sx, sy, thick=0.05, *, suffix=""):
        tag = {(-1, -1): "a", (-1, 1): "b", (1, -1): "c", (1, 1): "d"}[sx, sy]
        def place():
            return corner(sx, width), corner(sy, depth), (height - t) / 2
        return static_box(f"leg_{tag}{suffix}", size=(thick, thick, height - t), position=place())

    legs = mirrored(leg, 0.06, suffix="_oak")
    top = static_box("table_top", size=(width, depth, t), position=(0, 0, height - t / 2))
    first, *rest = legs
    assert first.name.startswith("leg_") and len(rest) == 3 and top.kind == "static"

    stack = []
    while len(stack) < 4:
        k = len(stack)
        stack.append(scene.cylinder(f"plate_{k}", radius=0.12, height=0.02, position=(0, 0, height + 0.011 + 0.022 * k), density=2400))
    else:
        scene.sphere("marble", radius=0.01, position=(0.3, 0, height + 0.3), density=2500)
    eye, target = (0, -2.6, 1.4), (0, 0, 0.6)
    scene.camera("front", eye=eye, target=target)
