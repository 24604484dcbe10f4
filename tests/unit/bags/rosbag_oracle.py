# SPDX-License-Identifier: BSD-3-Clause
"""Writes or reads a bag with the ROS 1 library of Debian.

  rosbag_oracle.py write FILE none|bz2|lz4   a bag with 50 messages of each type
  rosbag_oracle.py read FILE                 prints one line per message: topic, time in ns, values
"""
import sys

import genpy
import rosbag
from geometry_msgs.msg import PoseStamped, TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu, NavSatFix
from tf2_msgs.msg import TFMessage


def pose_of(message, i):
    message.x, message.y, message.z = i, i + 0.5, -i
    return message


def messages(i):
    image = Image(height=40, width=30, encoding="rgb8", step=90, data=bytes((j * i) % 256 for j in range(3600)))
    imu = Imu()
    pose_of(imu.angular_velocity, i)
    pose_of(imu.linear_acceleration, i / 3.0)
    pose = PoseStamped()
    pose_of(pose.pose.position, i)
    pose.pose.orientation.w = 1.0
    odometry = Odometry(child_frame_id="base")
    pose_of(odometry.pose.pose.position, i)
    odometry.pose.pose.orientation.w = 1.0
    transform = TransformStamped(child_frame_id="child")
    pose_of(transform.transform.translation, i)
    transform.transform.rotation.w = 1.0
    info = CameraInfo(height=480, width=640, distortion_model="plumb_bob", D=[0.1, 0.2, 0.3, 0.4, 0.5 * i])
    info.K = [500.0 + i, 0, 320, 0, 501, 240, 0, 0, 1]
    fix = NavSatFix(latitude=48.0 + i, longitude=11.0, altitude=520.5)
    for name, message in (("/image", image), ("/imu", imu), ("/pose", pose), ("/odom", odometry),
                          ("/transform", transform), ("/info", info), ("/fix", fix),
                          ("/compressed", CompressedImage(format="jpeg", data=bytes([i, 2, 3])))):
        message.header.frame_id = "frame"
        message.header.stamp = genpy.Time(100 + i, 7 * i)
        yield name, message
    transform.header.frame_id = "/parent"
    yield "/tf", TFMessage(transforms=[transform, transform])


def write(path, compression):
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=20000) as bag:
        for i in range(50):
            for topic, message in messages(i):
                bag.write(topic, message, genpy.Time(200 + i, i))


def read(path):
    with rosbag.Bag(path) as bag:
        for topic, message, time in bag.read_messages():
            values = []
            if topic == "/camera/imu":
                values = [message.angular_velocity.z, message.linear_acceleration.z]
            elif topic.endswith("image_raw"):
                values = [message.encoding, message.width, message.height, len(message.data), message.data[0]]
            elif topic.endswith("camera_info"):
                values = [message.K[0], message.K[4], message.D[1]]
            elif topic == "/tf_static":
                values = [message.transforms[0].child_frame_id, message.transforms[0].transform.translation.z]
            elif topic == "/ground_truth":
                values = [message.child_frame_id, message.transform.translation.x]
            print(topic, time.to_nsec(), *values)


if sys.argv[1] == "write":
    write(sys.argv[2], sys.argv[3])
else:
    read(sys.argv[2])
