from wsim.scene import Scene, SceneError
import sys, json

CONFIG = json.loads('{"boxes": [{"name": "a", "size": [0.1, 0.1, 0.1]}, {"name": "b", "size": [0.2, 0.1, 0.3]}, {"name": "bad name", "size": [1, 1, 1]}]}')

def build(scene: Scene) -> None:
    scene.ground()
    made = 0
    for k, item in enumerate(CONFIG["boxes"]):
        try:
            scene.box(item["name"], size=item["size"], position=(k * 0.4, 0, item["size"][2] / 2), density=item.get("density", 700))
        except SceneError as error:
            print("skipped:", error, file=sys.stderr)
        else:
            made += 1
        finally:
            pass
    assert made == 2, f"{made=}"
    try:
        threshold = float(CONFIG["threshold"])
    except (KeyError, ValueError):
        threshold = 0.5
    scene.camera("cam", eye=(0, -2, threshold + 0.5), target=(0.4, 0, 0.1))
