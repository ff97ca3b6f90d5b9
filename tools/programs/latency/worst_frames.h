#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "hal/camera.h"
#include "hal/clock.h"

namespace touchline::latency {

/// Pictures that cost the most work that anybody can hold in front of the camera, one after the other, each stamped
/// with the clock's time when it is asked for. Made of the venue's own colors, in the camera's format:
/// one color everywhere; pixels that alternate (most runs); single dots (most regions); combs that meet only in their
/// last row (most merges of labels); random colors; blocks and pairs of pixels that are no specks; clusters as ragged
/// as they get (percolation); a grid of patches as large as real ones (most pairs to match).
class WorstFrames final : public hal::Camera {
 public:
  /// `parameters.scan` says format, size and colors.
  WorstFrames(const PipelineParameters& parameters, const hal::Clock& clock);

  [[nodiscard]] const hal::CameraInfo& info() const override { return info_; }
  [[nodiscard]] const std::string& reason() const override { return reason_; }

  static constexpr std::size_t kPatterns = 9;

 private:
  // Values of three channels.
  using Value = std::array<std::uint8_t, 3>;

  Status do_open() override;
  Status do_start() override { return {}; }
  Result<hal::FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t) noexcept override {}
  void do_stop() override {}
  void do_close() override {}

  void choose_values();
  [[nodiscard]] std::size_t value_at(std::size_t pattern, std::size_t u, std::size_t v, std::uint32_t& random) const;
  void paint(std::size_t pattern);
  [[nodiscard]] Frame frame_of(std::size_t pattern) const;

  const PipelineParameters& parameters_;
  const hal::Clock& clock_;
  hal::CameraInfo info_;
  std::string reason_;
  std::vector<Value> values_;  // [0]: background, then one a color
  std::array<std::vector<std::uint8_t>, kPatterns> pictures_;
  std::uint32_t sequence_ = 0;
};

}  // namespace touchline::latency
