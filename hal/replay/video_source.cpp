#include "hal/replay/video_module.h"
#include "hal/replay/video_reader.h"

// The module's only visible function (kMakeVideoSource).
extern "C" [[gnu::visibility("default")]] touchline::hal::ReplaySource* touchline_make_video_source(
    const touchline::hal::VideoRequest& request);

touchline::hal::ReplaySource* touchline_make_video_source(const touchline::hal::VideoRequest& request) {
  return new touchline::hal::ffmpeg::VideoReader(request);
}
