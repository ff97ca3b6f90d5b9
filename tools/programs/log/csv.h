#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/files/output_file.h"
#include "hal/poses/pose_decoder.h"
#include "hal/recording/ssl_log.h"
#include "hal/result.h"
#include "tools/programs/log/recorded_frame.h"

namespace touchline::log {

/// Writes a row for each robot and ball of each frame (docs/recordings.md). Cells without a value are empty. Errors are
/// those of OutputFile.
class CsvWriter {
 public:
  Result<void> open(const std::string& path);
  /// Adds sightings, tracks and commands.
  Result<void> add(const RecordedFrame& frame);
  /// Adds what a packet with poses tells. Returns false if it cannot be read.
  Result<bool> add(const hal::SslLogMessage& message);
  Result<void> commit() { return file_.commit(); }
  [[nodiscard]] std::uint64_t rows() const { return rows_; }

 private:
  struct Row {
    double time_s = 0.0;
    std::optional<std::uint32_t> session{};
    std::uint64_t frame = 0;
    std::string_view kind{}, object{}, team{};
    std::optional<int> id{};
    std::optional<double> x_m{}, y_m{}, theta_rad{}, v_mps{}, w_radps{}, confidence{};
    std::string_view state{};
  };
  Result<void> write(const Row& row);
  Result<void> add_tracks(const Tracks& tracks, const RecordedFrame& frame, Row row);

  hal::OutputFile file_;
  std::string line_;
  hal::SentPoses poses_;
  std::uint64_t rows_ = 0;
};

}  // namespace touchline::log
