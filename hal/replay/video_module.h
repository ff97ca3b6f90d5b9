#pragma once

#include <memory>
#include <string>

#include "hal/files/interruption.h"
#include "hal/replay/replay_source.h"
#include "hal/result.h"

// The decoder of videos: a module that is loaded when the first video is opened. It alone needs FFmpeg's libraries for
// reading, and the package touchline-tools contains it, so a board that replays no video does without them.
namespace touchline::hal {

/// What the module needs to know. It is built and installed together with the programs, so both have the same types.
struct VideoRequest {
  const char* path;
  double rate_hz;  // above 0: replaces the stream's time stamps
  PixelFormat format;
  // The program's wait_until_ready(): the module has variables of its own.
  bool (*wait_until_ready)(int descriptor, Ready what);
};

/// The module's only function: a source that is not open yet, made with new.
using MakeVideoSource = ReplaySource*(const VideoRequest&);
inline constexpr char kMakeVideoSource[] = "touchline_make_video_source";
inline constexpr char kVideoModule[] = "touchline-video.so";

/// Makes the source of a video from the module, which is searched for where the program's run path says
/// (CMakeLists.txt). kUnsupported: there is no such module, or it cannot be loaded. The message does not name the path.
Result<std::unique_ptr<ReplaySource>> make_video_source(const std::string& path, double rate_hz, PixelFormat format,
                                                        const char* module = kVideoModule);

}  // namespace touchline::hal
