"""Stand-ins for the packages of robots' makers, with a little physics behind them, to run the guide's examples by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np

G_M_S2 = 9.80665
STROKE_MM, STEP_MM, MOST_N, NEWTON_PER_AMPERE = 85.0, 0.37, 20.0, 20.0


@dataclass
class World:
    """An arm of seven joints, a gripper, and a springy object at the pose ``around``."""

    poses: dict[str, tuple[float, ...]]
    levers_m: dict[int, float]
    mass_kg: float = 0.25
    width_mm: float = 60.0
    newton_per_mm: float = 1.0
    moves: bool = True
    pose: str = ""
    gap_mm: float = STROKE_MM
    force_n: float = 0.0
    holds: bool = False
    clock_s: float = 0.0
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(1))

    def go(self, angles: Any) -> bool:
        if not self.moves:
            return False
        wanted = tuple(angles)
        self.pose = next(name for name, pose in self.poses.items() if np.allclose(pose, wanted))
        return True

    def close_to(self, gap_mm: float) -> None:
        between = self.pose == "around" or self.holds
        self.force_n = min(self.newton_per_mm * max(0.0, self.width_mm - gap_mm), MOST_N) if between else 0.0
        yielded = self.width_mm - self.force_n / self.newton_per_mm
        self.gap_mm = max(gap_mm, yielded) if self.force_n else gap_mm
        held, self.holds = self.holds, self.force_n > 5.0
        assert self.holds or not held or self.pose == "around", "the object fell"

    @property
    def read_gap_mm(self) -> float:
        return float(STROKE_MM - np.round((STROKE_MM - self.gap_mm) / STEP_MM) * STEP_MM)

    def torques_nm(self) -> list[float]:
        weight = self.mass_kg * G_M_S2 * (self.holds and self.pose == "weighing")
        still = [0.1 * joint + weight * self.levers_m.get(joint, 0.0) for joint in range(7)]
        return [torque + float(self.rng.normal(0, 0.02)) for torque in still]


def modules(**contents: dict[str, Any]) -> dict[str, ModuleType]:
    """Modules by their names, dots written as double underscores, with all packages above them."""
    found: dict[str, ModuleType] = {}
    for key, content in contents.items():
        parts = key.split("__")
        for depth in range(1, len(parts) + 1):
            name = ".".join(parts[:depth])
            found.setdefault(name, ModuleType(name))
            if depth > 1:
                setattr(found[".".join(parts[: depth - 1])], parts[depth - 1], found[name])
        vars(found[".".join(parts)]).update(content)
    return found


class Repeated(list[Any]):
    """A repeated field of a message."""

    def add(self) -> Any:
        self.append(SimpleNamespace())
        return self[-1]


def kortex() -> dict[str, ModuleType]:
    """Kinova's API; what it calls a router is the world."""

    class BaseClient:
        def __init__(self, world: World) -> None:
            self.world, self.told = world, list[Callable[[Any], None]]()

        def OnNotificationActionTopic(self, told: Callable[[Any], None], options: object) -> int:  # noqa: N802
            self.told.append(told)
            return 1

        def Unsubscribe(self, handle: int) -> None:  # noqa: N802
            self.told.clear()

        def ExecuteAction(self, action: Any) -> None:  # noqa: N802
            joints = action.reach_joint_angles.joint_angles.joint_angles
            assert [joint.joint_identifier for joint in joints] == list(range(7))
            arrived = self.world.go(joint.value for joint in joints)
            for told in self.told:
                told(SimpleNamespace(action_event="end" if arrived else "abort"))

        def SendGripperCommand(self, command: Any) -> None:  # noqa: N802
            assert command.mode == "position"
            self.world.close_to(STROKE_MM * (1 - command.gripper.finger[0].value))

    class BaseCyclicClient:
        def __init__(self, world: World) -> None:
            self.world = world

        def RefreshFeedback(self) -> Any:  # noqa: N802
            world = self.world
            share = 100 * (1 - world.read_gap_mm / STROKE_MM)
            milliampere = 1000 * (world.force_n + float(world.rng.normal(0, 0.1))) / NEWTON_PER_AMPERE
            motor = SimpleNamespace(position=share, current_motor=milliampere)
            return SimpleNamespace(
                actuators=[SimpleNamespace(torque=torque) for torque in world.torques_nm()],
                interconnect=SimpleNamespace(gripper_feedback=SimpleNamespace(motor=[motor])),
            )

    def action() -> Any:
        return SimpleNamespace(
            reach_joint_angles=SimpleNamespace(joint_angles=SimpleNamespace(joint_angles=Repeated()))
        )

    def command() -> Any:
        return SimpleNamespace(gripper=SimpleNamespace(finger=Repeated()))

    messages = {"Action": action, "GripperCommand": command, "NotificationOptions": SimpleNamespace}
    words = {"GRIPPER_POSITION": "position", "ACTION_END": "end", "ACTION_ABORT": "abort"}
    return modules(
        kortex_api__autogen__messages__Base_pb2={**messages, **words},
        kortex_api__autogen__client_stubs__BaseClientRpc={"BaseClient": BaseClient},
        kortex_api__autogen__client_stubs__BaseCyclicClientRpc={"BaseCyclicClient": BaseCyclicClient},
    )


class Node:
    """A node of ROS, whose topics tell of the world; without a camera it has no images."""

    def __init__(self, world: World, joints: list[str], image: np.ndarray | None = None) -> None:
        self.world, self.joints, self.image = world, joints, image
        self.has_effort = True
        self.listeners: list[tuple[Any, Callable[[Any], None]]] = []

    def create_subscription(self, kind: Any, topic: str, told: Callable[[Any], None], depth: int) -> Any:
        self.listeners.append((kind, told))
        return self.listeners[-1]

    def destroy_subscription(self, subscription: Any) -> None:
        self.listeners.remove(subscription)


def ros() -> dict[str, ModuleType]:
    """Enough of rclpy and its messages."""

    class JointState(SimpleNamespace):
        pass

    class Image(SimpleNamespace):
        pass

    class JointTrajectoryPoint(SimpleNamespace):
        def __init__(self, **fields: Any) -> None:
            super().__init__(time_from_start=SimpleNamespace(sec=0), **fields)

    class Trajectory:
        Goal = staticmethod(lambda: SimpleNamespace(trajectory=SimpleNamespace()))
        Result = SimpleNamespace(SUCCESSFUL=0)

    class Grip:
        Goal = staticmethod(lambda: SimpleNamespace(command=SimpleNamespace()))

    class Future:
        def __init__(self, value: Any) -> None:
            self.value = value

        def done(self) -> bool:
            return self.value is not None

        def result(self) -> Any:
            return self.value

    class ActionClient:
        def __init__(self, node: Node, kind: Any, name: str) -> None:
            self.node, self.kind = node, kind

        def wait_for_server(self, timeout_sec: float) -> bool:
            return True

        def send_goal_async(self, goal: Any) -> Future:
            world, error = self.node.world, 0
            if self.kind is Trajectory:
                (point,) = goal.trajectory.points
                error = 0 if world.go(point.positions) else -4
            else:
                world.close_to(STROKE_MM * (1 - goal.command.position[0] / 0.8))
            result = SimpleNamespace(result=SimpleNamespace(error_code=error, error_string="path tolerance violated"))
            return Future(SimpleNamespace(accepted=True, get_result_async=lambda: Future(result)))

    def spin_once(node: Node, timeout_sec: float) -> None:
        world = node.world
        world.clock_s += 0.01
        stamp = SimpleNamespace(sec=int(world.clock_s), nanosec=round(1e9 * (world.clock_s % 1)))
        header = SimpleNamespace(stamp=stamp)
        for kind, told in tuple(node.listeners):
            if kind is JointState:
                finger = 0.8 * (1 - world.read_gap_mm / STROKE_MM)
                effort = [*world.torques_nm(), 0.0] if node.has_effort else []
                names = [*node.joints, "finger_joint"]
                told(JointState(header=header, name=names, position=[0.0] * 7 + [finger], effort=effort))
            elif node.image is not None:
                height, width = node.image.shape[:2]
                padded = np.pad(node.image[..., ::-1].reshape(height, 3 * width), ((0, 0), (0, 5)))
                told(
                    Image(
                        header=header,
                        height=height,
                        width=width,
                        step=3 * width + 5,
                        encoding="bgr8",
                        data=padded.tobytes(),
                    )
                )

    return modules(
        rclpy={"spin_once": spin_once, "spin_until_future_complete": lambda node, future, timeout_sec: None},
        rclpy__action={"ActionClient": ActionClient},
        control_msgs__action={"FollowJointTrajectory": Trajectory, "ParallelGripperCommand": Grip},
        sensor_msgs__msg={"JointState": JointState, "Image": Image},
        trajectory_msgs__msg={"JointTrajectoryPoint": JointTrajectoryPoint},
    )
