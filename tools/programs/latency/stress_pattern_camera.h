#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "tools/programs/latency/clutter_picture.h"

namespace touchline::latency {

/// A camera that cycles through synthetic pictures which are as expensive to process as possible. Each picture is
/// stamped with the time at which it is requested. The pictures use the venue's colors and the camera's format: one
/// color everywhere; alternating pixels (most runs); single pixels (most regions); combs whose teeth meet only in the
/// last row (most merges of labels); random colors; blocks of 2 x 2 pixels and pairs of pixels, which the minimum area
/// does not remove; clusters at the percolation threshold (most ragged); a grid of patches of real size (most pairs to
/// match); and the pictures of worst_clutter(), which have the slowest whole steps.
class StressPatternCamera final : public hal::Camera {
 public:
  /// `parameters.scan` gives format, size and colors; it must outlive this object.
  StressPatternCamera(const PipelineParameters& parameters, const hal::Clock& clock);

  [[nodiscard]] const hal::CameraInfo& info() const override { return info_; }

  /// Number of patterns of alternating colors; the pictures of worst_clutter() follow.
  static constexpr std::size_t kPatterns = 9;

 private:
  // Values of the three channels.
  using Value = PixelValue;

  Result<void> do_open() override;
  Result<void> do_start() override { return {}; }
  Result<hal::FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t) noexcept override {}
  void do_stop() override {}
  void do_close() override {}

  void choose_values();
  [[nodiscard]] std::size_t value_at(std::size_t pattern, std::size_t u, std::size_t v, std::uint32_t& random) const;
  void paint(std::size_t pattern);
  void paint_clutter_picture(std::size_t number, const CameraModel& camera);
  template <class ValueAt>
  void fill(std::size_t pattern, ValueAt value_at);
  [[nodiscard]] Frame frame_of(std::size_t pattern) const;

  const PipelineParameters& parameters_;
  const hal::Clock& clock_;
  hal::CameraInfo info_;
  std::vector<Value> values_;  // entry 0: background, then one per color
  std::vector<std::vector<std::uint8_t>> pictures_;
  std::uint32_t sequence_ = 0;
};

}  // namespace touchline::latency
