"""Pictures of a Newton model with glass and water, without a display, on the CPU or a CUDA device.

Newton's ray-traced camera sensor draws the opaque shapes. The same rays are then cast through the glass and the
fluids' surfaces (`wsim.kernels.render`), and both are blended by depth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp
from newton._src.geometry.bvh import compute_shape_world_transforms_launch
from newton.sensors import SensorCamera

from wsim.kernels.render import composite, display, faces, sky
from wsim.progress import silent
from wsim.scene.following import camera_at
from wsim.sim import render_materials, render_near, render_views
from wsim.sim.cord_shapes import CordShapes
from wsim.sim.render_surface import FluidMesh
from wsim.solvers.launch import launch_shared

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsim.progress import Progress
    from wsim.scene.world import Camera, World

render_near.nearer()

Color = tuple[float, float, float]
REACH = 1000.0  # [m] along a ray that a film shows
FRAMED = 0.8  # of half of what a camera has in its frame, which a scene that fills it takes up


@dataclass(frozen=True)
class CameraImage:
    """One camera's picture.

    Attributes:
        rgb: (H, W, 3) uint8, sRGB.
        shape_index: (H, W) int32, index into `model.shape_label` of the opaque shape seen through glass and water;
            -1 where there is none, and where a fluid lets less than 2 % of its light through.
        depth: (H, W) float32, distance of that shape along the camera's optical axis [m], and where a fluid hides it
            of the fluid; 0 where there is none.
    """

    rgb: np.ndarray
    shape_index: np.ndarray
    depth: np.ndarray


@dataclass(frozen=True)
class Style:
    """Light and sky; colours are linear RGB."""

    sun_color: Color = (0.92, 0.85, 0.72)
    sun_direction: Color = render_views.SUN  # from the sun into the scene; a distant light of the world goes first
    ambient_up: Color = (0.24, 0.28, 0.34)  # on faces that look up
    ambient_down: Color = (0.12, 0.11, 0.10)  # on faces that look down
    zenith: Color = (0.10, 0.26, 0.60)
    horizon: Color = (0.55, 0.67, 0.80)
    checker_contrast: float = 0.13  # of the ground's pattern; 0 is plain
    reflection: float = 1.0  # 0 is none, 1 is Fresnel's
    scatter: float = 1.0  # 0: water and glass only absorb
    refraction: bool = True  # by Snell's law, where a ray comes into a fluid
    shadows: bool = True
    smooth_edges: bool = True
    edges: float = 0.55  # share of the light that is taken where a thing ends; 0 draws no edges


class CameraRenderer:
    """Renders every camera of a world.

    Args:
        model: Newton model made from the world's stage; `model.shape_label` has the prim paths. The colours of the
            world's shapes are set, and its shape BVH is rebuilt without the world's glass.
        world: What the stage says: cameras, colours, glass, fluids. Without a camera, a three-quarter view that has
            everything in frame is used, with prim `/World/default_camera`.
        width: Picture width [px] for all cameras, in place of their own.
        height: Picture height [px], likewise; one of the two keeps the aspect ratio.
        world_index: Which of the model's worlds is drawn.
        style: Light and sky.
        looks: What shapes look like, of a model that has their colours already and hides what is hidden.
        reach: How far along a ray anything is drawn [m]; kernels are compiled for each.
        progress: Told about the compilation of kernels, which a first use needs.

    Attributes:
        cameras: The cameras drawn, with the size of their pictures.
        shape_prims: Prim path by shape index.
    """

    def __init__(
        self,
        model: Any,
        world: World,
        width: int | None = None,
        height: int | None = None,
        *,
        world_index: int = 0,
        style: Style | None = None,
        looks: render_materials.ShapeLooks | None = None,
        reach: float = REACH,
        progress: Progress = silent,
    ) -> None:
        if not 0 <= world_index < max(int(model.world_count), 1):
            raise ValueError(f"world_index {world_index}: the model has {model.world_count} worlds")
        self.model = model
        self.world = world
        self.style = style or Style()
        self.cameras = [render_views.resized(c, width, height) for c in _cameras_of(world)]
        self.shape_prims = [str(label) for label in model.shape_label]
        self._device, self._world_index = model.device, world_index
        self._world_indices = wp.array([world_index], dtype=wp.int32, device=self._device)
        self._init_shapes(looks)
        self._init_fluids(world_index)
        self._init_sensor(reach)
        self._views = [self._view(camera) for camera in self.cameras]
        self._compile(progress)

    def look_through(self, cameras: Sequence[Camera]) -> None:
        """Draw with these from now on, in place of the world's, and things of one colour in different shades."""
        shaded = render_materials.told_apart(self._looks.color, self._thing)
        render_materials.paint(self.model, [replace(self._looks, color=shaded)])
        self.cameras = list(cameras)
        self._views = [self._view(camera) for camera in self.cameras]

    def shapes_in(self, camera: Camera, state: Any, width: int) -> np.ndarray:
        """The shape-index image (H, W) int32 of a small picture, glass looked through, -1 where there is none."""
        self._place(state)
        view = self._view(render_views.resized(camera, width, None))
        self._follow([view], state)
        self._look_at_opaque(view, state, view.rays)
        shape = view.opaque_shape.numpy()[0]
        return np.where(shape < int(composite.NO_SHAPE), shape, 0).astype(np.int32) - (shape >= int(composite.NO_SHAPE))

    def render(
        self, state: Any, fluids: Mapping[str, Any] | None = None, cameras: Sequence[str] | None = None
    ) -> dict[str, CameraImage]:
        """Draw the world as it stands in `state`.

        Args:
            state: Newton state of the model.
            fluids: Particle centres [m] by fluid prim: (N, 3) numbers, or a Warp array of vec3.
            cameras: Prims of the cameras to draw; all by default.

        Returns:
            One picture for each camera, by camera prim.

        Raises:
            KeyError: `fluids` names a fluid that the world does not have.
            ValueError: positions of a wrong shape.
        """
        self._place(state)
        self._fluid_mesh.update(fluids or {})
        wanted = [v for v in self._views if cameras is None or v.camera.prim in cameras]
        self._follow(wanted, state)
        return {view.camera.prim: self._draw(view, state) for view in wanted}

    def _place(self, state: Any) -> None:
        """Bring the shapes to where a state has their bodies."""
        self._cords.update(state)
        self.model.bvh_refit_shapes(state)
        if self.model.shape_count > 0 and self.model.bvh_shape_count_enabled == 0:
            # Where all is glass Newton's camera has nothing to meet, and leaves the poses as they are: not set.
            compute_shape_world_transforms_launch(self.model, state)

    def _follow(self, views: Sequence[_View], state: Any) -> None:
        """Bring the cameras that follow bodies to where those are."""
        if any(view.follows is not None for view in views):
            poses = state.body_q.numpy()
            for view in views:
                if view.follows is not None:
                    moved = camera_at(view.camera, self.world, poses[view.follows])
                    view.pose.assign(np.array([render_views.camera_pose(moved)], dtype=np.float32))

    def _init_shapes(self, looks: render_materials.ShapeLooks | None) -> None:
        model = self.model
        self._cords = CordShapes(model, self.world)
        self._edges = self.style.edges if looks is None else 0.0  # a sensor sees none
        self._bends = self.style.refraction and looks is None  # and what it tells of lies where it is
        if looks is None:
            looks = render_materials.shape_looks(model, self.world, self._world_index)
            render_materials.paint(model, [looks])
            render_materials.hide(model, model.state(), looks.hidden)
        self._glass = render_materials.Glass(looks.panes, self._device)
        thing = render_materials.things(model, self.world, looks.ground)
        self._looks, self._thing = looks, thing
        self._thing_of_shape = wp.array(thing, dtype=wp.int32, device=self._device)
        self._shape_is_ground = wp.array(looks.ground, dtype=wp.int32, device=self._device)

    def _init_fluids(self, world_index: int) -> None:
        fluids = self.world.fluids
        self._fluid_mesh = FluidMesh(self.model, self.world, world_index)
        extinction = np.array([render_materials.extinction_of_fluid(f) for f in fluids] or [np.zeros(3)])
        self._fluid_extinction = wp.array(extinction, dtype=wp.vec3f, device=self._device)
        opaque = [1.0 - np.exp(-a.mean() * f.spacing) for a, f in zip(extinction, fluids, strict=False)] or [0.0]
        self._fluid_opaque = wp.array(opaque, dtype=wp.float32, device=self._device)
        colors = [f.color for f in fluids] or [(0.0, 0.0, 0.0)]
        self._fluid_color = wp.array(colors, dtype=wp.vec3f, device=self._device)
        gaps = [1.6 * f.spacing for f in fluids] or [0.0]
        self._fluid_gap = wp.array(gaps, dtype=wp.float32, device=self._device)

    def _init_sensor(self, reach: float) -> None:
        style = self.style
        self._sun = _unit(_sun_direction(self.world, style))
        self._sensor = SensorCamera(self.model, load_textures=False)
        self._sensor.create_default_light(
            enable_shadows=style.shadows, direction=wp.vec3f(*self._sun), color=style.sun_color
        )
        self._sensor.set_ambient_light(style.ambient_up, style.ambient_down)
        self._config = SensorCamera.RenderConfig(
            enable_shadows=style.shadows,
            enable_particles=False,
            enable_backface_culling=False,
            max_distance=reach,
        )

    def _view(self, camera: Camera) -> _View:
        w, h, device = camera.width, camera.height, self._device
        fov = render_views.vertical_fov(camera)
        return _View(
            camera=camera,
            follows=self._body(camera.follows),
            rays=SensorCamera.compute_camera_rays_pinhole(w, h, camera_fov=fov, device=device),
            pose=wp.array([render_views.camera_pose(camera)], dtype=wp.transformf, device=device),
            look=self._look(camera),
            passing=wp.zeros((h, w), dtype=composite.Light, device=device),
            bent_rays=wp.zeros((h, w, 1, 2), dtype=wp.vec3f, device=device),
            row_goes_on=wp.zeros(h, dtype=wp.int32, device=device),
            light=wp.zeros((1, h, w), dtype=wp.vec3f, device=device),
            opaque_depth=wp.zeros((1, h, w), dtype=wp.float32, device=device),
            opaque_shape=wp.zeros((1, h, w), dtype=wp.uint32, device=device),
            color=wp.zeros((h, w), dtype=wp.vec3f, device=device),
            encoded=wp.zeros((h, w), dtype=wp.vec3f, device=device),
            rgb=wp.zeros((h, w, 3), dtype=wp.uint8, device=device),
            depth=wp.zeros((h, w), dtype=wp.float32, device=device),
            shape=wp.zeros((h, w), dtype=wp.int32, device=device),
        )

    def _body(self, prim: str | None) -> int | None:
        """The model's index of a body of the world that is drawn."""
        if prim is None:
            return None
        worlds = self.model.body_world.numpy()
        for k, label in enumerate(self.model.body_label):
            if str(label) == prim and worlds[k] in (-1, self._world_index):
                return k
        raise ValueError(f"the model has no body {prim} for a camera to follow")

    def _look(self, camera: Camera) -> Any:
        style = self.style
        low, high = render_views.bounds(self.world)
        # As large as the scene is, or as what the camera has in its frame: a small thing may fly far.
        seen = float(np.linalg.norm(np.subtract(camera.target, camera.eye))) * np.tan(np.radians(camera.fov / 2))
        radius = max(0.5 * float(np.linalg.norm(high - low)), FRAMED * seen)
        look = sky.Look()
        look.sun_direction = wp.vec3(*self._sun)
        look.sun_color = wp.vec3(*style.sun_color)
        look.ambient = wp.vec3(*style.ambient_up)
        look.ambient_below = wp.vec3(*style.ambient_down)
        look.zenith = wp.vec3(*style.zenith)
        look.horizon = wp.vec3(*style.horizon)
        look.fog_distance = 34.0 * max(radius, 1e-3)
        look.checker = 2.0 ** round(np.log2(max(radius, 1e-3) / 2.5))
        look.checker_contrast = style.checker_contrast
        look.reflection = style.reflection
        look.scatter = style.scatter
        look.pixel_angle = render_views.vertical_fov(camera) / camera.height
        return look

    def _look_at_opaque(self, view: _View, state: Any, rays: wp.array) -> None:
        self._sensor.update(
            state,
            view.pose,
            rays,
            hdr_color_image=view.light,
            depth_image=view.opaque_depth,
            shape_index_image=view.opaque_shape,
            world_indices=self._world_indices,
            render_config=self._config,
        )

    def _draw(self, view: _View, state: Any) -> CameraImage:
        self._look_at_opaque(view, state, view.rays)
        if self._composite(view, first=True, bends=self._bends and self._fluid_mesh.id != 0):
            self._look_at_opaque(view, state, view.bent_rays)
            self._composite(view, first=False, bends=False)
        wp.launch(
            display.encode, dim=view.color.shape, inputs=[view.color], outputs=[view.encoded], device=self._device
        )
        if self._edges > 0.0:
            wp.launch(
                display.draw_edges,
                dim=view.color.shape,
                inputs=[self._thing_of_shape, view.shape, view.depth, self._edges],
                outputs=[view.encoded],
                device=self._device,
            )
        finish = display.smooth_edges if self.style.smooth_edges else display.quantize
        wp.launch(finish, dim=view.color.shape, inputs=[view.encoded], outputs=[view.rgb], device=self._device)
        return CameraImage(
            rgb=view.rgb.numpy().copy(), shape_index=view.shape.numpy().copy(), depth=view.depth.numpy().copy()
        )

    def _composite(self, view: _View, first: bool, bends: bool) -> bool:
        """Take the rays to where they are bent, or to their ends; whether any goes on."""
        view.row_goes_on.zero_()
        launch_shared(
            composite.composite,
            dim=view.color.shape,
            inputs=[
                view.rays,
                view.pose,
                view.opaque_depth,
                view.opaque_shape,
                view.light,
                self._shape_is_ground,
                self._media(),
                view.look,
                first,
                bends,
                view.passing,
                view.bent_rays,
            ],
            outputs=[view.row_goes_on, view.color, view.depth, view.shape],
            device=self._device,
        )
        return bends and bool(view.row_goes_on.numpy().any())

    def _media(self) -> Any:
        mesh, glass = self._fluid_mesh, self._glass
        media = faces.Media()
        media.shape_pose = self.model.bvh_shape_world_transforms
        media.glass_shape, media.glass_boxes = glass.shape, glass.box_count
        media.glass_half, media.glass_mesh = glass.half, glass.mesh
        media.glass_extinction, media.glass_color = glass.extinction, glass.color
        media.fluid_mesh, media.fluid_normals, media.fluid_of_vertex = mesh.id, mesh.normals, mesh.fluid_of_vertex
        media.fluid_extinction, media.fluid_color = self._fluid_extinction, self._fluid_color
        media.fluid_opaque, media.fluid_gap = self._fluid_opaque, self._fluid_gap
        return media

    def _compile(self, progress: Progress) -> None:
        """Draw once, with a drop of each fluid, so that later frames take no time for compilation."""
        stage = "preparing the camera"
        progress(stage, 0.0, 1.0)
        drop = np.zeros((1, 3), dtype=np.float32)
        self.render(
            self.model.state(), {f.prim: drop + np.asarray(f.center, dtype=np.float32) for f in self.world.fluids}
        )
        progress(stage, 1.0, 1.0)


@dataclass
class _View:
    """A camera with its rays and its buffers."""

    camera: Camera
    follows: int | None  # the model's index of the body that it follows
    rays: wp.array
    pose: wp.array
    look: Any
    passing: wp.array  # what has come along each ray so far
    bent_rays: wp.array
    row_goes_on: wp.array
    light: wp.array
    opaque_depth: wp.array
    opaque_shape: wp.array
    color: wp.array
    encoded: wp.array
    rgb: wp.array
    depth: wp.array
    shape: wp.array


def _cameras_of(world: World) -> list[Camera]:
    return world.cameras or [render_views.default_camera(world)]


def _sun_direction(world: World, style: Style) -> Color:
    return next((light.direction for light in world.lights if light.kind == "distant"), style.sun_direction)


def _unit(v: Color) -> Color:
    length = float(np.linalg.norm(v))
    if length < 1e-9:
        raise ValueError(f"a light's direction must not be zero, got {v}")
    return (v[0] / length, v[1] / length, v[2] / length)
