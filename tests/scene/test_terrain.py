"""Terrain as it is authored: heights and slopes by closed forms, areas, and what is scattered on it."""

import math

import numpy as np
import pytest
import trimesh
from PIL import Image as Picture

from wsim.scene import Area, Hill, Image, Kerb, Level, Noise, Ramp, Road, Scene, SceneError, Step, Surface
from wsim.scene.describe import describe


def land(*layers, size=(20.0, 12.0), cell=0.25, **options):
    return Scene().terrain("land", size=size, cell=cell, layers=layers, **options)


def statics(scene, path):
    return {static.prim: static.shapes for static in describe(scene.save(path / "t.usda")).statics}


def solid(shape):
    return trimesh.Trimesh(shape.vertices, shape.triangles)


def test_a_plane_is_met_exactly():
    made = land(lambda x, y: 0.2 * x - 0.1 * y + 0.5, position=(3.0, -2.0, 1.0))
    for x, y in ((3.0, -2.0), (5.13, 1.97), (-6.9, -7.9)):
        assert made.height(x, y) == pytest.approx(1.5 + 0.2 * (x - 3.0) - 0.1 * (y + 2.0), abs=1e-9)
    assert made.slope_deg(4.0, 0.0) == pytest.approx(math.degrees(math.atan(math.hypot(0.2, 0.1))))
    assert made.slope_deg(4.0, 0.0, heading_deg=0.0) == pytest.approx(math.degrees(math.atan(0.2)))
    assert made.slope_deg(4.0, 0.0, heading_deg=-90.0) == pytest.approx(math.degrees(math.atan(0.1)))
    assert made.normal(4.0, 0.0) == pytest.approx(np.array([-0.2, 0.1, 1.0]) / math.sqrt(1.05))


def test_a_bowl_is_met_by_a_share_of_a_cell():
    """Of z = k (x² + y²) / 2 the triangles of a cell h are at most k h² / 4 above, and nowhere below."""
    k, cell = 0.1, 0.5
    made = land(lambda x, y: 0.5 * k * (x * x + y * y), cell=cell)
    random = np.random.default_rng(1)
    for x, y in random.uniform(-5.9, 5.9, (200, 2)):
        off = made.height(x, y) - 0.5 * k * (x * x + y * y)
        assert -1e-12 <= off <= 0.25 * k * cell**2 + 1e-12


def test_a_hill_is_steepest_halfway_up():
    made = land(Hill((1.0, 0.0), 5.0, 2.0), cell=0.1)
    assert made.height(1.0, 0.0) == pytest.approx(2.0)
    assert made.height(3.5, 0.0) == pytest.approx(1.0, abs=1e-3)
    assert made.height(6.1, 0.0) == 0.0
    steepest = math.degrees(math.atan(math.pi * 2.0 / (2.0 * 5.0)))
    assert made.slope_deg(3.47, 0.02) == pytest.approx(steepest, abs=0.1)


def test_noise_is_bounded_and_of_its_seed_whatever_the_cells():
    coarse, fine = (land(Noise(0.5, 4.0, octaves=2, seed=7), cell=cell) for cell in (0.5, 0.25))
    other = land(Noise(0.5, 4.0, octaves=2, seed=8), cell=0.5)
    places = [(x, y) for x in np.arange(-10.0, 10.1, 0.5) for y in np.arange(-6.0, 6.1, 0.5)]
    heights = np.array([[made.height(*at) for at in places] for made in (coarse, fine, other)])
    assert heights[0] == pytest.approx(heights[1], abs=1e-12)
    assert np.abs(heights[0] - heights[2]).max() > 0.1
    assert np.abs(heights).max() <= 0.5 and np.ptp(heights[0]) > 0.2
    assert abs(heights[0].mean()) < 0.05
    # Gradient noise is 0 where its lattice is: every wavelength, for all octaves.
    assert [coarse.height(x, y) for x in (-8.0, 0.0, 4.0) for y in (-4.0, 0.0, 4.0)] == pytest.approx([0.0] * 9)


@pytest.mark.parametrize(("deep", "near"), [(8, 0.02), (16, 1e-4)])
def test_a_picture_spans_its_heights(deep, near, tmp_path):
    """Grey from left to right, its top, which is the far side, brighter."""
    across, up = np.meshgrid(np.linspace(0.0, 0.5, 41), np.linspace(0.5, 0.0, 25))
    grey = np.round((across + up) * (2**deep - 1)).astype(np.uint8 if deep == 8 else np.uint16)
    Picture.fromarray(grey).save(tmp_path / "grey.png")
    made = land(Image(tmp_path / "grey.png", low=-1.0, high=3.0), cell=0.5)
    for x, y in ((-10.0, -6.0), (0.0, 0.0), (10.0, 6.0), (4.0, -3.3)):
        assert made.height(x, y) == pytest.approx(-1.0 + 4.0 * ((x + 10.0) / 40.0 + (y + 6.0) / 24.0), abs=near)


def test_a_mesh_gives_its_upper_side(tmp_path):
    box = trimesh.creation.box((4.0, 2.0, 1.0))
    box.apply_translation((1.0, 0.0, 0.3))
    box.export(tmp_path / "box.obj")
    made = land(Surface(tmp_path / "box.obj"))
    assert made.height(1.0, 0.0) == pytest.approx(0.8)
    assert made.height(-3.0, 0.0) == 0.0


def test_ramps_steps_and_kerbs():
    made = land(Ramp((-8.0, 0.0), (-4.0, 0.0), 2.0, 0.6, beyond=1.0), Step((4.0, 0.0), 0.2),
                Kerb([(0.0, -6.0), (0.0, 6.0)], height=0.12, width=0.5))  # fmt: skip
    assert made.height(-6.0, 0.3) == pytest.approx(0.3)
    assert made.slope_deg(-6.1, 0.3) == pytest.approx(math.degrees(math.atan(0.15)))
    assert made.height(-3.5, 0.0) == pytest.approx(0.6) and made.height(-2.5, 0.0) == 0.0
    assert made.height(-6.0, 1.5) == 0.0
    assert made.height(0.0, 3.0) == pytest.approx(0.12) and made.height(0.6, 3.0) == 0.0
    assert made.height(3.7, 0.0) == 0.0 and made.height(4.1, 2.0) == pytest.approx(0.2)


def test_a_level_place_is_level_and_goes_over():
    made = land(lambda x, y: 0.3 * x, Level((2.0, 0.0), 1.5, blend=2.0))
    assert [made.height(2.0 + dx, dy) for dx, dy in ((-1.2, 0.0), (1.0, 1.0), (0.0, 0.0))] == pytest.approx([0.6] * 3)
    assert made.height(6.0, 0.0) == pytest.approx(1.8)


def test_a_road_is_level_across_and_keeps_the_slope_along():
    road = Road([(-9.0, 0.0), (9.0, 0.0)], width=4.0, shoulder=1.0)
    made = land(lambda x, y: 0.1 * x + 0.3 * y, road)
    for x in (-7.0, 0.3, 8.0):
        assert [made.height(x, y) for y in (-1.9, 0.0, 1.9)] == pytest.approx([0.1 * x] * 3, abs=1e-9)
    assert made.height(0.0, 4.0) == pytest.approx(1.2)


def test_a_roads_line_goes_through_its_points():
    points = [(0.0, 0.0), (10.0, 4.0), (20.0, -3.0), (30.0, 0.0)]
    line = Road(points).line(0.2)
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).max() < 0.25
    for each in points:
        assert np.linalg.norm(line - each, axis=1).min() < 1e-9
    turns = np.diff(np.unwrap(np.arctan2(*np.diff(line, axis=0).T[::-1])))
    assert np.abs(turns).max() < 0.05  # it is smooth


def test_areas_have_their_surface_and_share_the_ground(tmp_path):
    """Their upper sides together are the field's, and each is a closed solid."""
    scene = Scene()
    ice = Area("ice", outline=[(0.0, -3.0), (4.0, -3.0), (4.0, 3.0), (0.0, 3.0)], friction=0.1)
    mud = Area("mud", outline=[(3.0, 0.0), (8.0, -5.0), (8.0, 5.0)], rolling_friction=0.2, color=(0.2, 0.1, 0.05))
    scene.terrain("land", size=(20.0, 12.0), cell=0.5, layers=[Noise(0.4, 6.0, octaves=2)], areas=[ice, mud],
                  thickness=2.0, friction=0.8)  # fmt: skip
    shapes = {shape.prim.rsplit("/", 1)[1]: shape for shape in statics(scene, tmp_path)["/World/land"]}
    assert {name: shape.friction for name, shape in shapes.items()} == pytest.approx(
        {"geometry": 0.8, "ice": 0.1, "mud": 0.8}
    )
    assert shapes["mud"].rolling == pytest.approx(0.2) and shapes["ice"].rolling is None
    tops = 0.0
    for shape in shapes.values():
        mesh = solid(shape)
        assert mesh.is_watertight and mesh.volume > 0.0
        up = mesh.face_normals[:, 2] > 1e-3
        tops += float((mesh.area_faces * mesh.face_normals[:, 2])[up].sum())
    assert tops == pytest.approx(240.0, rel=1e-5)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_narrow_area_is_joined_whichever_way_it_runs(way, tmp_path):
    """Along a diagonal of 9 cells it takes in one more at each of their 8 corners, and the ground none."""
    scene = Scene()
    ice = Area("ice", outline=[(-4.6, -4.4 * way), (4.4, 4.6 * way), (4.6, 4.4 * way), (-4.4, -4.6 * way)])
    scene.terrain("land", size=(11.0, 11.0), cell=1.0, layers=[lambda x, y: 0.0], areas=[ice])
    shapes = {shape.prim.rsplit("/", 1)[1]: shape for shape in statics(scene, tmp_path)["/World/land"]}
    for name, cells in (("ice", 17), ("geometry", 121 - 17)):
        mesh = solid(shapes[name])
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(cells)


def test_an_area_that_joining_takes_is_named():
    """Of four cells two on a diagonal are joined through one of the others, all that an area has."""
    one = Area("one", outline=[(0.0, -1.0), (1.0, -1.0), (1.0, 0.0), (0.0, 0.0)])
    two = Area("two", outline=[(-1.0, 0.0), (0.0, 0.0), (0.0, 1.0), (-1.0, 1.0)])
    three = Area("three", outline=[(-0.8, -0.6), (0.6, 0.8), (0.8, 0.6), (-0.6, -0.8)])
    with pytest.raises(SceneError, match=r'areas\[0\]: "one" holds the middle of no cell'):
        land(lambda x, y: 0.0, size=(2.0, 2.0), cell=1.0, areas=[one, two, three])


def test_rocks_lie_in_the_ground_apart_from_each_other_and_from_the_road(tmp_path):
    road = Road([(-18.0, 0.0), (18.0, 2.0)], width=4.0)
    found = []
    for seed in (3, 3, 4):
        scene = Scene()
        made = scene.terrain("land", size=(40.0, 20.0), layers=[Noise(0.5, 8.0, octaves=2), road])
        rocks = scene.scatter("rock", on=made, count=30, size=(0.3, 1.2), clear=[(road, 0.5), ((0.0, 6.0), 2.0)],
                              seed=seed)  # fmt: skip
        shapes = statics(scene, tmp_path)
        meshes = [solid(shapes[rock.path][0]) for rock in rocks]
        found.append([shapes[rock.path][0].position for rock in rocks])
    line = road.line(0.1)
    for mesh in meshes:
        assert mesh.is_watertight and mesh.volume > 0.9 * mesh.convex_hull.volume
    for shape in (shapes[rock.path][0] for rock in rocks):
        x, y, z = shape.position
        corners = np.array(shape.vertices)
        low, high = corners[:, 2].min() + z, corners[:, 2].max() + z
        assert low < made.height(x, y) < high
        assert (made.height(x, y) - low) / (high - low) == pytest.approx(0.2, abs=1e-4)
        reach = np.linalg.norm(corners[:, :2], axis=1).max()
        assert np.linalg.norm(line - (x, y), axis=1).min() > 2.5 + 0.9 * reach
        assert math.hypot(x, y - 6.0) > 2.0 + 0.9 * reach
    assert found[0] == found[1] and found[0] != found[2]
    places = np.array(found[2])[:, :2]
    apart = np.linalg.norm(places[:, None] - places, axis=2) + 10.0 * np.eye(len(places))
    assert apart.min() > 0.25


def test_trees_stand_on_the_ground(tmp_path):
    scene = Scene()
    made = scene.terrain("land", size=(40.0, 30.0), layers=[Noise(0.5, 8.0, octaves=2)])
    trees = scene.scatter("tree", ["conifer", "deciduous_tree"], on=made, count=8, seed=1)
    for tree in trees:
        x, y, z = scene.stage.GetPrimAtPath(tree.path).GetAttribute("xformOp:translate").Get()
        around = [made.height(x + 0.3 * math.cos(a), y + 0.3 * math.sin(a)) for a in np.arange(8) * math.pi / 4]
        assert z == pytest.approx(min(around)) and z <= made.height(x, y) + 1e-9
    assert set(statics(scene, tmp_path)) == {"/World/land", *(tree.path for tree in trees)}


@pytest.mark.parametrize(
    ("layer", "says"),
    [
        (Noise(-1.0, 4.0), "layers[1].amplitude = -1 must be >= 0"),
        (Noise(1.0, 4.0, octaves=9), "layers[1].octaves = 9: the finest bumps are"),
        (Hill((0.0,), 1.0, 1.0), "layers[1].position = (0.0,) has 1 numbers; it must be 2"),
        (Image("gone.png", 0.0, 1.0), 'layers[1].file = "gone.png" is no PNG file that is there'),
        (Surface("gone.obj"), 'layers[1].file = "gone.obj" is not there'),
        (Ramp((0.0, 0.0), (0.0, 0.0), 1.0, 1.0), "layers[1].end = (0.0, 0.0) is where it starts"),
        (Kerb([(0.0, 0.0)]), "layers[1].points has 1 points; it must be 2 to 2000"),
        (Kerb([(0.0, 0.0), (1.0, 0.0)], width=0.1), "layers[1].width = 0.1 m is narrower than a cell"),
        (Road([(0.0, 0.0), (5.0, 0.0)], width=-1.0), "layers[1].width = -1 must be > 0"),
        (Noise, "layers[1] = "),
        (lambda x, y: 1e9, "layers are 1e+09 m high"),
        ([[0.0, 1.0], [2.0]], "layers[1] = "),
    ],
)
def test_a_bad_layer_is_named(layer, says):
    with pytest.raises(SceneError) as caught:
        land(lambda x, y: 0.0, layer)
    assert says in str(caught.value) and str(caught.value).startswith('terrain("land")')


@pytest.mark.parametrize(
    ("area", "says"),
    [
        (Area("ice"), "areas[0].outline or road: give one of them"),
        (Area("ice", outline=[(0.0, 0.0), (0.1, 0.0), (0.0, 0.1)]), 'areas[0]: "ice" holds the middle of no cell'),
        (Area("geometry", outline=[(0, 0), (5, 0), (0, 5)]), "name 'geometry' is already used"),
        (Area("ice", outline=[(0, 0), (5, 0), (0, 5)], friction=-1.0), "areas[0].friction = -1 must be >= 0"),
        (Area("ice", road=3.0), "areas[0].road = 3.0 must be a Road"),
        ("ice", 'areas[0] = "ice" must be an Area'),
    ],
)
def test_a_bad_area_is_named(area, says):
    with pytest.raises(SceneError) as caught:
        land(lambda x, y: 0.0, areas=[area])
    assert says in str(caught.value)


def test_where_there_is_no_room_or_no_ground_it_says_so():
    scene = Scene()
    made = scene.terrain("land", size=(4.0, 4.0), layers=[lambda x, y: 0.0])
    with pytest.raises(SceneError, match=r"count = 50: after \d+ there is no room"):
        scene.scatter("rock", on=made, count=50, size=(1.0, 1.0))
    with pytest.raises(SceneError, match="is not on it: it is 4 x 4 m"):
        made.height(3.0, 0.0)
    with pytest.raises(SceneError, match=r"must be what scene\.terrain returned"):
        scene.scatter("rock", on="land", count=1)


@pytest.mark.parametrize(
    ("what", "size", "says"),
    [
        ("rocks", (6.0, 6.0), 'size = (6, 6) m: one of 6 m is too wide for on = "land", which must be 6 m or more'),
        ("conifer", (0.3, 1.0), 'what = "conifer": one of '),
    ],
)
def test_what_is_wider_than_the_terrain_is_named(what, size, says):
    scene = Scene()
    made = scene.terrain("land", size=(9.0, 0.5), cell=0.25, layers=[lambda x, y: 0.0])
    with pytest.raises(SceneError) as caught:
        scene.scatter("thing", what, on=made, count=1, size=size)
    assert says in str(caught.value) and str(caught.value).startswith('scatter("thing")')
    assert "and is 0.5; take a smaller one, or larger terrain" in str(caught.value)
    assert not scene.stage.GetPrimAtPath("/World/thing_0")
    assert len(scene.scatter("stone", on=made, count=2, size=(0.4, 0.4))) == 2


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (lambda made: made.slope_deg(0.0, 0.0, "x"), 'heading_deg = "x" must be a number in deg'),
        (lambda made: made.slope_deg(0.0, 0.0, math.inf), "heading_deg = inf must be finite in deg"),
        (lambda made: made.place(0.0, 0.0, math.nan), "above = nan must be finite in m"),
        (lambda made: made.place(0.0, 0.0, None), "above = None must be a number in m"),
        (lambda made: made.place("x", 0.0), 'x = "x" must be a number in m'),
        (lambda made: made.has(None, 0.0), "x = None must be a number in m"),
        (lambda made: made.has(0.0, math.nan), "y = nan must be finite in m"),
        (lambda made: made.has(0.0, 0.0, "x"), 'margin = "x" must be a number in m'),
    ],
)
def test_a_bad_number_that_a_terrain_is_asked_is_named(asked, says):
    with pytest.raises(SceneError) as caught:
        asked(land(lambda x, y: 0.0))
    assert says in str(caught.value) and str(caught.value).startswith('terrain("land")')
