import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.records import Recording
from tests.store.importing.bags.made import header, make, ns, number, topic_map, write_bag

HALF = math.sqrt(0.5)


def point(x: float, y: float, z: float, kind: str = "Point") -> Any:
    return make(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)


def turn(x: float, y: float, z: float, w: float) -> Any:
    return make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)


def pose(x: float = 0.1, rotation: Any = None) -> Any:
    return make("geometry_msgs/msg/Pose", position=point(x, 0.2, 0.3), orientation=rotation or turn(HALF, 0, 0, HALF))


def stamped(x: float = 0.1, rotation: Any = None, frame: str = "table") -> Any:
    return make("geometry_msgs/msg/PoseStamped", header=header(ns(0), frame), pose=pose(x, rotation))


def read(folder: Path, messages: list[Any], use: str = "pose = 'object_pose'") -> Recording:
    bag = write_bag(folder / "bag", [("/pose", ns(place), message) for place, message in enumerate(messages)])
    (found,) = read_bag(bag, topic_map(folder, f'[topics."/pose"]\n{use}'))
    return found


def test_a_pose_has_its_frame_and_rotation(tmp_path: Path) -> None:
    """Place and frame are the message's, and the quaternion begins with w; the original is kept."""
    found = read(tmp_path, [stamped()]).object_pose
    assert found is not None
    assert found.translation_m == (0.1, 0.2, 0.3)
    assert found.quaternion == (HALF, HALF, 0.0, 0.0)
    assert found.frame == "table"
    assert found.original["orientation"] == [HALF, 0.0, 0.0, HALF]


@pytest.mark.parametrize(("take", "x"), [("first", 0.0), ("last", 2.0)])
def test_one_of_several_is_taken(tmp_path: Path, take: str, x: float) -> None:
    """The first or the last of several poses is taken, as the map says, and told."""
    use = f"pose = {{of = 'gripper_pose', take = '{take}', frame = 'base'}}"
    found = read(tmp_path, [stamped(float(place)) for place in range(3)], use)
    assert found.gripper_pose is not None
    assert (found.gripper_pose.translation_m[0], found.gripper_pose.frame) == (x, "base")
    assert f"/pose: the gripper_pose is the {take} of 3 messages" in found.notices


def test_transforms_and_covariances_are_poses_too(tmp_path: Path) -> None:
    """A transform, a pose with a covariance, and a pose without a header are taken; no frame is told."""
    transform = make(
        "geometry_msgs/msg/TransformStamped",
        header=header(ns(0), "base"),
        child_frame_id="tool",
        transform=make("geometry_msgs/msg/Transform", translation=point(1, 2, 3, "Vector3"), rotation=turn(0, 0, 0, 1)),
    )
    covariance = make("geometry_msgs/msg/PoseWithCovariance", pose=pose(), covariance=np.zeros(36))
    with_covariance = make("geometry_msgs/msg/PoseWithCovarianceStamped", header=header(ns(0), "map"), pose=covariance)
    found = []
    for name, message in (("a", transform), ("b", with_covariance), ("c", pose())):
        (tmp_path / name).mkdir()
        found.append(read(tmp_path / name, [message]))
    assert [(one.object_pose.translation_m, one.object_pose.frame) for one in found if one.object_pose] == [
        ((1.0, 2.0, 3.0), "base"),
        ((0.1, 0.2, 0.3), "map"),
        ((0.1, 0.2, 0.3), "unstated"),
    ]
    assert found[2].notices == ("/pose: names no frame",)


def test_a_pose_in_a_field_is_taken(tmp_path: Path) -> None:
    """The map may say in which field of a message the pose is."""
    array = make("geometry_msgs/msg/PoseArray", header=header(ns(0), "map"), poses=[pose(), pose(0.7)])
    found = read(tmp_path, [array], "pose = {of = 'object_pose', field = 'poses[1]'}")
    assert found.object_pose is not None
    assert (found.object_pose.translation_m[0], found.object_pose.frame) == (0.7, "map")


def test_a_rotation_that_is_none_is_kept_as_given(tmp_path: Path) -> None:
    """A quaternion that nobody set is no rotation; it stays in the original and is told."""
    found = read(tmp_path, [stamped(rotation=turn(0, 0, 0, 0))])
    assert found.object_pose is not None
    assert found.object_pose.quaternion is None
    assert found.object_pose.original["orientation"] == [0, 0, 0, 0]
    assert found.notices == ("/pose: the rotation is a quaternion of length 0 and not 1: it is kept as given only",)


def test_a_pose_that_is_not_finite_is_told(tmp_path: Path) -> None:
    """A place with NaN is no pose; the recording is kept, with a notice."""
    found = read(tmp_path, [stamped(math.nan)])
    assert found.object_pose is None
    assert found.notices == ("/pose: the pose has numbers that are not finite: it is not kept",)


def test_what_is_no_pose_is_refused(tmp_path: Path) -> None:
    """A message without a pose is refused, and so is a field that is not there."""
    with pytest.raises(StoreError, match="/pose: holds no pose"):
        read(tmp_path, [number(1.0)])
    with pytest.raises(StoreError, match="there is no field 'tool'"):
        read(tmp_path / "again", [number(1.0)], "pose = {of = 'object_pose', field = 'tool'}")
