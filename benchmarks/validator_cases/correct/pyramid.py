from wsim.scene import Scene

edge, gap, rows = 0.2, 0.002, 6

def build(scene):
    scene.ground()
    wood = scene.material("wood", density=500, friction=0.6)
    blocks = [
        scene.box(
            f"block_{row}_{k}",
            size=[edge, edge, edge],
            position=[(k - (rows - row - 1) / 2) * (edge + gap), 0, edge * (row + 0.5)],
            material=wood,
        )
        for row in range(rows)
        for k in range(rows - row)
    ]
    assert len(blocks) == rows * (rows + 1) // 2
    names = sorted(block.name for block in blocks)
    print(", ".join(names))
    scene.camera("front", eye=(0, -4, 1), target=(0, 0, 0.5))
