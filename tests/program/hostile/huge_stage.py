def build(scene):
    scene.ground()
    scene.stage.GetPrimAtPath("/World/ground").SetDocumentation("x" * 100_000_000)
