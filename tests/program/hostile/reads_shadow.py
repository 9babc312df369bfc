def build(scene):
    with open("/etc/shadow") as file:
        print("SECRET", file.read())
    scene.ground()
