"""Which cameras a recording says that its pictures were taken with."""

import numpy as np
import pytest

from wsim.recording import RecordingWriter, read
from wsim.scene.world import Camera


def test_views_are_the_worlds_and_those_beside_them(tmp_path, world):
    """The world's come first; pictures of one beside them are kept, too."""
    own = [camera.model_copy(update={"eye": (9.0, 0.0, 1.0)}) for camera in world.cameras]
    beside = Camera(prim="/World/default_camera_whole", eye=(0.0, -9.0, 1.0), target=(0.0, 0.0, 0.5))
    with RecordingWriter(tmp_path / "r.rrd", world) as writer:
        writer.views([*own, beside], np.zeros(0), np.zeros((0, len(world.bodies), 7)))
        writer.image(0.0, beside.prim, np.zeros((4, 6, 3), dtype=np.uint8))
    found = read(tmp_path / "r.rrd")
    assert found.views == found.world.cameras == [*own, beside]
    assert len(found.images[beside.prim]) == 1


@pytest.mark.parametrize("wrong", [[], [1, 0], [0, 0]])
def test_views_without_one_of_the_worlds_or_with_one_twice_are_refused(tmp_path, world, wrong):
    cameras = [Camera(prim=f"/World/camera_{k}", eye=(0.0, -3.0 - k, 1.0), target=(0.0, 0.0, 0.0)) for k in range(2)]
    with (
        RecordingWriter(tmp_path / "r.rrd", world.model_copy(update={"cameras": cameras})) as writer,
        pytest.raises(ValueError, match="come first, each once"),
    ):
        writer.views([cameras[k] for k in wrong], np.zeros(0), np.zeros((0, len(world.bodies), 7)))
