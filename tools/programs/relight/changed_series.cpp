#include "tools/programs/relight/changed_series.h"

#include <filesystem>
#include <system_error>

#include "hal/replay/replay_camera.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::relight {

Result<std::uint64_t> change_series(const std::string& input, const std::string& out, const PictureChange& change,
                                    const Things& things, std::uint64_t every) {
  namespace fs = std::filesystem;
  hal::ReplayCamera camera({input, PixelFormat::kRgb24, 0.0});
  TOUCHLINE_TRY(camera.open());
  TOUCHLINE_TRY(camera.start());
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return Error{ErrorCode::kIo, out + ": cannot be created: " + error.message()};
  const fs::path folder = fs::is_directory(input) ? fs::path(input) : fs::path(input).parent_path();
  std::uint64_t written = 0;
  for (std::uint64_t number = 0;; ++number) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (lease.code() == ErrorCode::kEndOfStream) return written;
    if (!lease.ok()) return lease.error();
    if (number % every != 0) continue;
    // For a video, the camera reports the video's name with every frame.
    const bool is_video = fs::path(camera.file()) == fs::path(input).filename() && camera.frame_count() != 1;
    const std::string stem = is_video ? formatted("%06llu", static_cast<unsigned long long>(number))
                                      : fs::path(camera.file()).stem().string();
    const fs::path target = fs::path(out) / (stem + ".png");
    if (fs::equivalent(folder.empty() ? "." : folder, out, error) && fs::exists(target)) {
      return Error{ErrorCode::kInconsistent, target.string() + ": would be replaced; name another folder"};
    }
    hal::Picture picture = calibrate::picture_of(lease.value().frame());
    if (const auto found = things.find(camera.file()); found != things.end()) paint(found->second, picture);
    picture = changed(picture, change);
    TOUCHLINE_TRY(hal::write_picture(target.string(), picture, {.sync = false}));
    ++written;
  }
}

}  // namespace touchline::relight
