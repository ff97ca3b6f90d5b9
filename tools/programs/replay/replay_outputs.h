#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "firmware/config/configuration.h"
#include "hal/files/output_file.h"
#include "hal/result.h"
#include "tools/programs/replay/annotation.h"
#include "tools/programs/replay/motion_plot.h"
#include "tools/programs/replay/picture_output.h"
#include "tools/programs/replay/replay.h"

namespace touchline::replay {

/// kInconsistent: an output of the options would overwrite an input or another output.
Result<void> check_outputs(const ReplayOptions& options);

/// The outputs of a replay: lines of results, annotated pictures, and a plot, each if the options name it.
class ReplayOutputs {
 public:
  explicit ReplayOutputs(const ReplayOptions& options) : options_(options) {}

  /// Opens the files. `rate_hz`: of an annotated video.
  Result<void> open(const config::Configuration& configuration, double rate_hz);
  /// Uses the names and colors of another configuration from now on.
  void use(const config::Configuration& configuration);
  /// Adds a frame. `has_picture`: its pixels are valid; without them nothing is drawn.
  Result<void> add(const StepTrace& trace, std::uint64_t frame, const std::string& file, bool has_picture);
  /// Gives the files their names.
  Result<void> finish();

 private:
  Result<void> write_plot();

  const ReplayOptions& options_;
  AnnotationStyle style_;
  hal::OutputFile lines_, plot_file_;
  PictureOutput pictures_;
  std::unique_ptr<Annotator> annotator_;
  std::optional<Instant> begin_;  // time of the video's beginning on the session's clock
  Duration next_stamp_{};         // of the next session's first frame
  MotionPlot plot_;
};

}  // namespace touchline::replay
