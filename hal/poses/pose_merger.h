#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/types.h"
#include "hal/poses/pose_decoder.h"

namespace touchline::hal {

/// What a source of poses knows of the game.
struct PoseTeams {
  bool own_is_yellow = false;
  FixedVector<RobotId, kMaxRobotsPerTeam> own_ids;  // own robots with other ids get no id
};

/// Sightings of one frame.
struct MergedPoses {
  Sightings sightings;
  Instant capture_time{};
};

/// Makes one frame of what several cameras saw. A frame is complete when each camera that sends has sent. Cameras that
/// are not synchronized are grouped so that the longest pause between two of them separates frames. The frame has the
/// time of the newest picture, and what the others saw is moved to it with the velocity between that camera's last two
/// pictures. An object in an area that several cameras see is at the mean of its positions.
class PoseMerger {
 public:
  explicit PoseMerger(const PoseTeams& teams) : teams_(teams) {}

  /// Adds a camera's packet. Returns whether a frame is complete; it is in `out` then.
  bool add(const SentPoses& poses, Instant capture_time, Instant arrival, MergedPoses& out);

 private:
  struct Camera {
    SentPoses now, former;
    Instant captured{}, former_captured{}, heard{};
    bool is_known = false, is_new = false;
    double gap_s = 0.0;  // mean time until the next camera's picture
  };
  void note_gap(std::size_t index, Instant captured);
  [[nodiscard]] static bool is_active(const Camera& camera, Instant arrival);
  // Whether a picture of this camera completes a frame, whose pictures are of about the same time.
  [[nodiscard]] bool ends_frame(std::size_t index, Instant captured, Instant arrival) const;
  void merge(MergedPoses& out);
  void add_robots(const Camera& camera, Instant at, Sightings& out);
  void choose_ball(Instant at, BallSighting& out);
  [[nodiscard]] RobotSighting sighting_of(const SentRobot& robot) const;

  const PoseTeams teams_;
  std::array<Camera, kMaxPoseCameras> cameras_{};
  std::size_t last_ = 0;                    // the camera whose picture came last
  std::array<float, kMaxRobots> weight_{};  // of each sighting: sum of the confidences that it is a mean of
  std::optional<FieldPoint> ball_;          // of the last frame with one
  Instant ball_seen_{};
};

}  // namespace touchline::hal
