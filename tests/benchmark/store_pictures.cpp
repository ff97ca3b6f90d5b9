#include "tests/benchmark/store_pictures.h"

#include <algorithm>

#include "tests/benchmark/clutter_step.h"
#include "tests/benchmark/mjpg_benchmark.h"
#include "tests/benchmark/step_benchmark.h"
#include "tests/benchmark/stored_frames.h"

namespace touchline::testing {
namespace {

// The tracks of a game's robots are settled after 16 of its frames, those of clutter after six.
constexpr std::size_t kGameFrames = 24;
constexpr int kClutterFrames = 8;

template <class Bytes>
void append(std::string& to, const Bytes* bytes, std::size_t count) {
  to.append(reinterpret_cast<const char*>(bytes), count);
}

StoredFrame stored(const Frame& frame, bool as_jpeg) {
  StoredFrame copy{frame.capture_time, {}};
  if (as_jpeg) {
    const std::vector<std::uint8_t> jpeg = camera_jpeg(frame);
    append(copy.bytes, jpeg.data(), jpeg.size());
    return copy;
  }
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    for (std::size_t row = 0; row < plane_rows(frame.format, plane, frame.height_px); ++row) {
      append(copy.bytes, frame.plane[plane] + row * frame.stride_bytes[plane],
             row_bytes(frame.format, plane, frame.width_px));
    }
  }
  return copy;
}

}  // namespace

Result<void> store_pictures(const std::string& picture, const std::string& format, const std::string& venue,
                            const std::string& file) {
  const bool mjpg = format == "mjpg";
  config::FilePaths files = mock_files();
  if (!mjpg) {
    files.venue = venue;
    files.overrides = {"camera.format=" + format};
  }
  std::vector<StoredFrame> frames;
  if (picture == "game") {
    StepBenchmark game;
    TOUCHLINE_TRY(game.prepare(files, kGameFrames));
    for (std::size_t i = 0; i < game.frames(); ++i) frames.push_back(stored(game.frame(i), mjpg));
    return write_frames(file, frames);
  }
  const auto all = latency::worst_clutter();
  const auto named = std::find_if(all.begin(), all.end(), [&](const auto& clutter) { return picture == clutter.name; });
  if (named == all.end()) return failure(ErrorCode::kNotFound, "there is no picture \"%s\"", picture.c_str());
  const auto recipe = latency::clutter_recipe_of(named->recipe);
  if (!recipe) return failure(ErrorCode::kInconsistent, "%s: not a recipe", named->name);
  ClutterStep clutter;
  TOUCHLINE_TRY(clutter.configure(files, ClutterTeams::kMock));
  clutter.show(*recipe);
  for (int i = 0; i < kClutterFrames; ++i) frames.push_back(stored(clutter.next_frame(), mjpg));
  return write_frames(file, frames);
}

}  // namespace touchline::testing
