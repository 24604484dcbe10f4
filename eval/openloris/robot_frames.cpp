// SPDX-License-Identifier: BSD-3-Clause
#include "eval/openloris/robot_frames.h"

#include <array>
#include <string>

#include "core/base/error.h"

namespace stillpoint::eval {
namespace {

struct SensorFrame {
  std::string_view name;
  std::array<double, 7> pose;  ///< tx ty tz [m], qx qy qz qw, of the sensor in base_link
};

using RobotFrames = std::array<SensorFrame, 6>;

constexpr RobotFrames kOfficeRobot{{
    {"d400_color",
     {0.2264836849091656, -0.05114194035652147, 0.916, -0.49676229968284136, 0.4998795887129771,
      -0.49510681269354095, 0.5081504289345848}},
    {"d400_depth",
     {0.22722047136786871, -0.06601512576001335, 0.9157872415132173, -0.49538006860636935,
      0.49954735142309487, -0.49840674562280746, 0.5065982108450463}},
    {"d400_imu",
     {0.21545245195759705, -0.07164430142403165, 0.9206998887739904, -0.49538006860636935,
      0.49954735142309487, -0.49840674562280746, 0.5065982108450463}},
    {"t265_fisheye1",
     {0.23757012582874237, -0.038724749600647444, 0.8950755692783204, -0.49597362846259985,
      0.49833071591566835, -0.4958921122758979, 0.5096740825539088}},
    {"t265_fisheye2",
     {0.2379100555955274, -0.10269086731607438, 0.8938944689217037, -0.4925125657739745, 0.4999316027612397,
      -0.4977612079783229, 0.5096406037074316}},
    {"t265_imu",
     {0.23769333650938815, -0.04942265635384921, 0.894903580913328, 0.5030437335657985, 0.49268060367606764,
      0.5074439466966938, 0.4967025929491916}},
}};

constexpr RobotFrames kMarketRobot{{
    {"d400_color",
     {0.398363566676407, 0.029117046016620643, 1.198511534258444, 0.5508509426177262, -0.5167305893488635,
      0.44976770953124534, -0.47671977566632984}},
    {"d400_depth",
     {0.399546294466062, 0.014453458565135675, 1.1984746547500458, 0.5499697614834611, -0.5171593202226934,
      0.4537274051736184, -0.47350917705472384}},
    {"d400_imu",
     {0.38894162200484866, 0.00842158791024528, 1.2052174620767606, 0.5504510403790713, -0.5176133892954977,
      0.4532057328200385, -0.47295305803713444}},
    {"t265_fisheye1",
     {0.873, 0.026, 0.68, -0.3949830160954541, 0.40598254312596027, -0.5999742016639807, 0.5649757065669153}},
    {"t265_fisheye2",
     {0.8696611328664977, -0.03799129213961659, 0.6804951110039751, -0.3919558964011141, 0.40672335425280526,
      -0.6018891254946375, 0.5645140999063238}},
    {"t265_imu",
     {0.8724694754706082, 0.015314402373202411, 0.6801628399570413, 0.4108974443723151, 0.39141685497790646,
      0.5636503288904802, 0.600211998038325}},
}};

const RobotFrames& frames_of(std::string_view scene) {
  for (const std::string_view known : {"office", "corridor", "home", "cafe"}) {
    if (scene == known) return kOfficeRobot;
  }
  if (scene == "market") return kMarketRobot;
  throw InputError("unknown OpenLORIS scene \"" + std::string(scene) +
                   "\"; expected one of: office, corridor, home, cafe, market");
}

}  // namespace

Pose openloris_frame(std::string_view scene, std::string_view frame) {
  const RobotFrames& frames = frames_of(scene);
  if (frame == "base_link") return Pose{};
  std::string known = "base_link";
  for (const SensorFrame& sensor : frames) {
    const std::array<double, 7>& v = sensor.pose;
    if (sensor.name == frame) {
      return Pose{Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized(), {v[0], v[1], v[2]}};
    }
    known += ", " + std::string(sensor.name);
  }
  throw InputError("unknown frame \"" + std::string(frame) + "\"; expected one of: " + known);
}

}  // namespace stillpoint::eval
