"""A program of ROS 2 drives the arm by `fivebar ros`, and reads it back: with rclpy of PyPI, without an installed ROS.

    drive.py PROGRAM

With each kind of drive it homes the arm by a service, switches its motors on, sends it along a trajectory and stops it at once.
With brushed motors it also gives set-points at 100 Hz, and is refused what cannot be followed.
"""

import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import rclpy
from builtin_interfaces.msg import Duration
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

DRIVEN = ["A", "E"]

# Built-in arms, and the leg with drives that speak the protocol of MIT-type drives.
ARMS = ["benchtop", "benchtop_stepper", "leg", "mit", "classroom_servo"]
MIT = "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0"


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.states, self.description, self.diagnostics = [], None, None
        self.create_subscription(JointState, "/joint_states", self.take, 50)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "/robot_description", self.describe, latched)
        self.create_subscription(DiagnosticArray, "/diagnostics", self.diagnose, 10)
        self.trajectories = self.create_publisher(JointTrajectory, "/joint_trajectory", 10)

    def take(self, message):
        self.states.append((time.monotonic(), message))

    def describe(self, message):
        self.description = message.data

    def diagnose(self, message):
        self.diagnostics = message.status[0]

    def wait(self, what, until, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            rclpy.spin_once(self, timeout_sec=0.05)
            found = until()
            if found:
                return found
        raise AssertionError(f"{what}: not within {seconds} s")

    def call(self, name):
        client = self.create_client(Trigger, f"/fivebar/{name}")
        self.wait(f"the service {name}", client.service_is_ready)
        answer = client.call_async(Trigger.Request())
        self.wait(f"the answer of {name}", answer.done, 60)
        return answer.result()

    def done(self, name):
        answer = self.call(name)
        assert answer.success and not answer.message, f"{name}: {answer.message}"

    def angles(self):
        """θ1, θ4 of a message that comes from now on [rad]."""
        self.states.clear()
        message = self.wait("a joint state", lambda: self.states and self.states[-1][1])
        assert message.name == ["A", "B", "D", "E"]
        return [message.position[0], message.position[3]]

    def send(self, points):
        message = JointTrajectory(joint_names=DRIVEN)
        for seconds, positions, velocities in points:
            whole = int(seconds)
            after = Duration(sec=whole, nanosec=round(1e9 * (seconds - whole)))
            message.points.append(JointTrajectoryPoint(positions=positions, velocities=velocities, time_from_start=after))
        self.trajectories.publish(message)


def off(one, other):
    return max(abs(a - b) for a, b in zip(one, other))


def it_goes_along_a_trajectory(driver):
    start = driver.angles()
    via = [start[0] + 0.1, start[1] - 0.05]
    driver.send([(0.5, via, []), (1.0, start, [])])
    driver.states.clear()
    driver.wait("the first point", lambda: driver.states and off(positions(driver), via) < 5e-3)
    driver.wait("the way back", lambda: off(positions(driver), start) < 1e-3)


def positions(driver):
    message = driver.states[-1][1]
    return [message.position[0], message.position[3]]


def set_points_at_100_hz_are_followed_and_read_back(driver, seconds=6.0):
    """Each message takes the place of the one before; states come at 100 Hz."""
    start, rate = driver.angles(), 100
    def motion(at):
        angle = 2 * math.pi * 0.5 * at
        way, speed = 0.05 * (1 - math.cos(angle)), 0.05 * math.pi * math.sin(angle)
        return [start[0] + way, start[1] + way], [speed, speed]
    driver.states.clear()
    begun, sent = time.monotonic(), 0
    while sent < seconds * rate:
        now = time.monotonic() - begun
        if now * rate >= sent:
            ahead = (sent + 2) / rate
            driver.send([(0.02, *motion(ahead))])
            sent += 1
        rclpy.spin_once(driver, timeout_sec=0.001)
    states = list(driver.states)
    length = states[-1][0] - states[0][0]
    share = len(states) / (rate * length)
    print(f"{len(states)} states in {length:.2f} s: {100 * share:.1f} % of 100 Hz", flush=True)
    assert share >= 0.99, f"{100 * share:.1f} %"
    # The arm is behind by the delay of the stream; so its place is compared with the motion some time ago.
    def worst(lag):
        late = [(at - begun - lag, message) for at, message in states if at - begun > 1 + lag]
        return max(off([m.position[0], m.position[3]], motion(at)[0]) for at, m in late)
    lag, error = min(((k / 100, worst(k / 100)) for k in range(30)), key=lambda pair: pair[1])
    print(f"{1000 * lag:.0f} ms behind within {1000 * error:.1f} mrad", flush=True)
    assert error < 0.02, f"{error} rad"


def what_cannot_be_followed_is_told(driver):
    start = driver.angles()
    driver.send([(0.05, [start[0] - 1.0, start[1]], [])])
    said = driver.wait("the reason", lambda: value(driver, "last motion") != "no failure" and value(driver, "last motion"))
    assert "rad/s²" in said, said
    assert off(driver.angles(), start) < 1e-3, "it moved"


def value(driver, key):
    values = driver.diagnostics.values if driver.diagnostics else []
    return {entry.key: entry.value for entry in values}.get(key, "no failure")


def an_emergency_stop_is_final(driver):
    start = driver.angles()
    driver.send([(3.0, [start[0] + 0.2, start[1] - 0.2], [])])
    driver.states.clear()
    driver.wait("motion", lambda: driver.states and off(positions(driver), start) > 0.02)
    driver.done("emergency_stop")
    driver.wait("its fault", lambda: driver.diagnostics and value(driver, "fault") != "0")
    driver.send([(1.0, start, [])])
    driver.wait("a refusal", lambda: value(driver, "last motion") != "no failure")
    driver.wait("rest", lambda: driver.diagnostics and "off" not in driver.diagnostics.message)
    answer = driver.call("motors_on")
    assert not answer.success, "the motors come on over a fault"
    driver.done("clear_fault")


def it_is_homed_and_switched_on(driver, robot):
    driver.wait("the description", lambda: driver.description)
    assert f'<robot name="{robot}">' in driver.description, driver.description[:300]
    driver.done("home")
    driver.done("motors_on")


def an_arm_is_driven(program, robot):
    with tempfile.TemporaryDirectory() as folder:
        file = robot
        if robot == "mit":
            text = subprocess.run([program, "robots", "leg"], capture_output=True, text=True, check=True).stdout
            file = pathlib.Path(folder, "mit.toml")
            file.write_text(text.replace('protocol = "odrive"', MIT))
        arm = subprocess.Popen([program, "ros", "--robot", str(file)], stdout=subprocess.PIPE, text=True)
        rclpy.init()
        try:
            assert "node /fivebar" in arm.stdout.readline()
            driver = Driver()
            if robot == "benchtop":
                refused = driver.call("motors_on")
                assert not refused.success and "home" in refused.message, refused.message
            it_is_homed_and_switched_on(driver, "leg" if robot == "mit" else robot)
            it_goes_along_a_trajectory(driver)
            if robot == "benchtop":
                set_points_at_100_hz_are_followed_and_read_back(driver)
                what_cannot_be_followed_is_told(driver)
            an_emergency_stop_is_final(driver)
            driver.destroy_node()
        finally:
            rclpy.try_shutdown()
            arm.send_signal(2)
            assert arm.wait(20) == 0, "the program ends by itself"


def every_kind_of_drive_goes_along_a_trajectory(program):
    for robot in ARMS:
        an_arm_is_driven(program, robot)
        print(f"ros: {robot}: passed", flush=True)


if __name__ == "__main__":
    every_kind_of_drive_goes_along_a_trajectory(*sys.argv[1:])
