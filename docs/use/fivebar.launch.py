"""Starts the arm as a node, and RViz: ros2 launch ./fivebar.launch.py robot:=my-arm.toml port:=/dev/ttyUSB0"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import LaunchConfigurationEquals, LaunchConfigurationNotEquals
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    robot, port = LaunchConfiguration("robot"), LaunchConfiguration("port")
    simulated = ["fivebar", "ros", "--robot", robot]
    return LaunchDescription([
        DeclareLaunchArgument("robot", default_value="benchtop", description="a built-in robot or a robot file"),
        DeclareLaunchArgument("port", default_value="", description="the controller's serial port; none: the simulated arm"),
        ExecuteProcess(cmd=simulated, output="screen", condition=LaunchConfigurationEquals("port", "")),
        ExecuteProcess(cmd=[*simulated, "--port", port], output="screen",
                       condition=LaunchConfigurationNotEquals("port", "")),
        Node(package="rviz2", executable="rviz2"),
    ])
