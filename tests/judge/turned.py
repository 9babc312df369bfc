"""A recorded world and all that is in it, gravity too, turned as one: nothing in it can tell."""

from dataclasses import replace

import numpy as np

from wsim.geometry.rotations import multiply, rotate


def any_turn(seed):
    """A random rotation (4,), uniform over all (Shoemake's: a normal vector of four, made a unit)."""
    q = np.random.default_rng(seed).normal(size=4)
    return q / np.linalg.norm(q)


def turned(recording, q):
    """The recording of the world turned about the origin by a quaternion (4,)."""

    def vector(v):
        return tuple(rotate(q, np.array(v, dtype=np.float64)).tolist())

    def rotation(own):
        return tuple(multiply(q, np.array(own, dtype=np.float64)).tolist())

    def all_of(array):
        return None if array is None else rotate(q, np.asarray(array, dtype=np.float64)).astype(np.float32)

    world = recording.world
    placed = {"position": vector, "rotation": rotation, "velocity": vector, "angular_velocity": vector}
    bodies = [
        body.model_copy(update={name: turn(getattr(body, name)) for name, turn in placed.items()})
        for body in world.bodies
    ]
    statics = [
        static.model_copy(
            update={
                "shapes": [
                    shape.model_copy(update={"position": vector(shape.position), "rotation": rotation(shape.rotation)})
                    for shape in static.shapes
                ]
            }
        )
        for static in world.statics
    ]
    joints = [
        joint.model_copy(
            update={"parent_anchor": vector(joint.parent_anchor), "parent_turn": rotation(joint.parent_turn)}
        )
        if joint.parent is None
        else joint
        for joint in world.joints
    ]
    cameras = [
        camera.model_copy(update={name: vector(getattr(camera, name)) for name in ("eye", "target", "up")})
        for camera in world.cameras
    ]
    made = {"bodies": bodies, "statics": statics, "joints": joints, "cameras": cameras}
    place, turn = all_of(recording.body_q[..., :3]), recording.body_q[..., 3:].astype(np.float64)

    def both_of(six):
        return np.concatenate([all_of(six[..., :3]), all_of(six[..., 3:])], axis=-1)

    return replace(
        recording,
        world=world.model_copy(update={**made, "gravity": vector(world.gravity)}),
        body_q=np.concatenate([place, multiply(np.broadcast_to(q, turn.shape), turn)], axis=-1).astype(np.float32),
        body_qd=both_of(recording.body_qd),
        contact_force=all_of(recording.contact_force),
        applied_impulse=all_of(recording.applied_impulse),
        applied_turn=all_of(recording.applied_turn),
        control_impulse=all_of(recording.control_impulse),
        wall_impulse=all_of(recording.wall_impulse),
        lead=None if recording.lead is None else both_of(recording.lead),
        contacts=None if recording.contacts is None else _turned_contacts(recording.contacts, all_of),
        ties=None if recording.ties is None else _turned_ties(recording.ties, all_of),
    )


def _turned_ties(track, all_of):
    """What joints, springs and ropes gave: the vectors among their sums."""
    joints, cords = track.joints.copy(), track.cords.copy()
    for sums, firsts in ((joints, (0, 3, 6, 9)), (cords, (0, 3))):
        for first in firsts:
            sums[..., first : first + 3] = all_of(sums[..., first : first + 3])
    return replace(track, joints=joints, cords=cords)


def _turned_contacts(track, all_of):
    """What pairs gave each other: the vectors among their sums."""
    sums = track.sums.copy()
    for first in (0, 4, 7, 10, 13):
        sums[:, first : first + 3] = all_of(sums[:, first : first + 3])
    return replace(track, sums=sums)
