"""Marks over pictures, and what tells things apart, on pictures of small scenes."""

import numpy as np

from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.labels import wholes
from wsim.scene.world import Camera
from wsim.sim import Simulation
from wsim.sim.cameras import CameraRenderer
from wsim.sim.marks import PIN, PUSH, SPECK, Marks, caption

BLANK = np.full((90, 160, 3), 120, dtype=np.uint8)
CAMERA = Camera(prim="/World/side", eye=(0.0, -4.0, 1.0), target=(0.0, 0.0, 1.0), width=160, height=90)


def described(scene, tmp_path):
    stage = scene.save(tmp_path / "stage.usda")
    return stage, describe(stage)


def of_colour(picture, colour):
    """Mean column and row of the pixels of a colour, and how many there are."""
    rows, columns = np.nonzero((picture == np.array(colour)).all(axis=2))
    return (columns.mean(), rows.mean(), len(rows)) if len(rows) else (np.nan, np.nan, 0)


def test_a_hinge_is_marked_where_it_is(tmp_path):
    """A rod of 1 m on a hinge, 1 m left of the middle at the height of the eye: 160 / (8 tan 25°) px left of it."""
    scene = Scene()
    rod = scene.box("rod", size=(1.0, 0.05, 0.05), position=(-0.5, 0.0, 1.0))
    scene.joint_revolute("hub", None, rod, axis="Y", anchor=(-1.0, 0.0, 1.0))
    _, world = described(scene, tmp_path)
    pose = np.array([[*body.position, *body.rotation] for body in world.bodies])
    column, row, count = of_colour(Marks(world, None).draw(BLANK, CAMERA, 0, pose), PIN)
    assert count > 3
    assert abs(column - (80.0 - 160.0 / (8.0 * np.tan(np.radians(25.0))))) < 1.0
    assert abs(row - 45.0) < 1.0


def test_a_push_is_an_arrow_from_where_it_comes(tmp_path):
    """Towards +X, to the right: it is left of the body's middle; half the push is half the arrow."""
    scene = Scene()
    scene.box("box", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 1.0))
    _, world = described(scene, tmp_path)
    pose = np.array([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]])
    push = np.array([[[2.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]], [[0.0, 0.0, 0.0]]])
    marks = Marks(world, push)
    drawn = [marks.draw(BLANK, CAMERA, frame, pose) for frame in range(3)]
    widths = [np.ptp(np.nonzero((picture == np.array(PUSH)).all(axis=2).any(axis=0))[0]) for picture in drawn[:2]]
    assert of_colour(drawn[0], PUSH)[0] < 80.0
    assert abs(widths[0] - 2.0 * widths[1]) <= 3.0
    assert (drawn[2] == BLANK).all()


def test_a_speck_is_ringed_and_has_its_way_where_the_camera_stands(tmp_path):
    """A box of 1 cm, 0.4 px of these pictures, goes 2 m to the right through their middle; one of 50 cm is no speck."""
    scene = Scene()
    scene.box("box", size=(0.01, 0.01, 0.01), position=(-1.0, 0.0, 1.0))
    _, world = described(scene, tmp_path)
    middle = np.linspace((-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), 21)
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    pose = np.array([[*middle[-1], 0.0, 0.0, 0.0, 1.0]])
    marks = Marks(world, None, [middle[:, None] + 0.01 * corners])
    column, row, count = of_colour(marks.draw(BLANK, CAMERA, 0, pose), SPECK)
    pixels = 160.0 / (8.0 * np.tan(np.radians(25.0)))  # a metre, 4 m off
    assert count > 6
    assert abs(column - (80.0 - pixels)) < 1.0 and abs(row - 45.0) < 1.0
    way = (marks.draw(BLANK, CAMERA, 20, pose) == np.array(SPECK)).all(axis=2).any(axis=0)
    assert abs(np.ptp(np.nonzero(way)[0]) - 2.0 * pixels) < 8.0
    follows = CAMERA.model_copy(update={"follows": "/World/box"})
    ringed = (marks.draw(BLANK, follows, 20, pose) == np.array(SPECK)).all(axis=2).any(axis=0)
    assert 3 < ringed.sum() < 12
    large = Marks(world, None, [middle[:, None] + 0.5 * corners])
    assert (large.draw(BLANK, CAMERA, 20, pose) == BLANK).all()


def test_a_caption_is_below(tmp_path):
    said = caption(BLANK, 1.25, "the ball comes to rest, and much more than there is room for in a line of it")
    assert said.shape == BLANK.shape
    assert (said[:60] == BLANK[:60]).all()
    assert (said[-6:] != BLANK[-6:]).any()


def test_a_vehicle_is_one_thing_and_a_box_beside_it_another(tmp_path):
    """So is a mechanism's part whose name does not begin with that of another."""
    scene = Scene()
    scene.ground()
    scene.box("box", size=(0.2, 0.2, 0.2), position=(5.0, 0.0, 0.1))
    scene.vehicle("car", "polaris", position=(0.0, 0.0, 0.0))
    rod = scene.box("rod", size=(1.0, 0.05, 0.05), position=(0.0, 5.0, 1.0))
    scene.joint_revolute("hub", None, rod, axis="Y", anchor=(0.0, 5.0, 1.0))
    _, world = described(scene, tmp_path)
    whole = wholes(world)
    assert (whole["/World/box"], whole["/World/rod"]) == ("/World/box", "/World/rod")
    assert {one for prim, one in whole.items() if "car" in prim} == {"/World/car"}
    assert len([prim for prim in whole if "car" in prim]) > 4
    assert [joint.prim for joint in Marks(world, None)._hinges] == ["/World/hub"]


def test_boxes_of_one_colour_are_told_apart(tmp_path):
    """Two that stand on each other, seen from the side: each has a shade, and there is a dark line between."""
    scene = Scene()
    wood = scene.material("wood", density=500.0, color=(0.45, 0.25, 0.1))
    for k in range(2):
        scene.box(f"box_{k}", size=(1.0, 1.0, 1.0), position=(0.0, 0.0, k + 0.5), material=wood)
    scene.camera("side", eye=(0.0, -5.0, 1.0), target=(0.0, 0.0, 1.0), width=160, height=90)
    stage, world = described(scene, tmp_path)
    simulation = Simulation(stage, device="cpu", draws=True)
    renderer = CameraRenderer(simulation.model, world)
    renderer.look_through(world.cameras)
    column = renderer.render(simulation.state)["/World/side"].rgb[:, 80].astype(float).sum(axis=1)
    upper, lower, line = column[36], column[54], column[43:48].min()
    assert abs(upper - lower) > 0.03 * upper
    assert line < 0.75 * min(upper, lower)
