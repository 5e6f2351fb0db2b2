# SPDX-License-Identifier: BSD-3-Clause
"""One of the nodes in a container of its own.

    ros2 launch pcl_slim_ros smoother.launch.py input:=/camera/points output:=/camera/smooth
    ros2 launch pcl_slim_ros smoother.launch.py node:=SplatNode config:=splats.yaml
"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import ComposableNodeContainer
from launch_ros.descriptions import ComposableNode
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = (
    ("input", "points", "topic of the clouds"),
    ("output", "points_smooth", "topic of the results"),
    ("node", "SmootherNode", "SmootherNode, NormalsNode or SplatNode"),
    ("name", "slim_smoother", "the node's name"),
    ("config", "smoother.yaml", "file of parameters, in the package's folder config unless the path is absolute"),
)


def generate_launch_description():
    config = PathJoinSubstitution([FindPackageShare("pcl_slim_ros"), "config", LaunchConfiguration("config")])
    node = ComposableNode(
        package="pcl_slim_ros",
        plugin=["pcl_slim_ros::", LaunchConfiguration("node")],
        name=LaunchConfiguration("name"),
        parameters=[config],
        remappings=[("input", LaunchConfiguration("input")), ("output", LaunchConfiguration("output"))],
        extra_arguments=[{"use_intra_process_comms": True}],
    )
    container = ComposableNodeContainer(
        name="slim_container",
        namespace="",
        package="rclcpp_components",
        executable="component_container",
        composable_node_descriptions=[node],
        output="screen",
    )
    arguments = [DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS]
    return LaunchDescription([*arguments, container])
