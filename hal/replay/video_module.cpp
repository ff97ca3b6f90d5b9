#include "hal/replay/video_module.h"

#include <dlfcn.h>

namespace touchline::hal {

Result<std::unique_ptr<ReplaySource>> make_video_source(const std::string& path, double rate_hz, PixelFormat format,
                                                        const char* module) {
  // Never unloaded: sources contain pointers to its code.
  void* const loaded = ::dlopen(module, RTLD_NOW | RTLD_LOCAL);
  void* const function = loaded == nullptr ? nullptr : ::dlsym(loaded, kMakeVideoSource);
  if (function == nullptr) {
    const char* const cause = ::dlerror();
    return failure(ErrorCode::kUnsupported,
                   "is not a picture (png, ppm, pgm, jpg, jpeg), and videos need the package touchline-tools: sudo apt "
                   "install touchline-tools (%s)",
                   cause == nullptr ? "the module is empty" : cause);
  }
  const VideoRequest request{path.c_str(), rate_hz, format, wait_until_ready};
  return std::unique_ptr<ReplaySource>(reinterpret_cast<MakeVideoSource*>(function)(request));
}

}  // namespace touchline::hal
