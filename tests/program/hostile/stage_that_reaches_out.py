def build(scene):
    scene.ground()
    scene.stage.GetRootLayer().subLayerPaths.append("/etc/passwd")
