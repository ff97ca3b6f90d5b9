#include "hal/replay/ffmpeg.h"

#include <array>
#include <cstdarg>
#include <mutex>

namespace touchline::hal::ffmpeg {
namespace {

thread_local LogCapture* active_capture = nullptr;

void capture_message(void* object, int level, const char* format, va_list arguments) {
  if (active_capture == nullptr || level > AV_LOG_WARNING) return;
  std::array<char, 512> line{};
  int print_prefix = 0;  // 0: without the decoder's address
  av_log_format_line2(object, level, format, arguments, line.data(), static_cast<int>(line.size()), &print_prefix);
  std::string text(line.data());
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  if (!text.empty()) active_capture->add(level, text);
}

}  // namespace

std::string error_text(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

LogCapture::LogCapture() : outer_(active_capture) {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_callback(capture_message); });
  active_capture = this;
}

LogCapture::~LogCapture() { active_capture = outer_; }

void LogCapture::add(int level, const std::string& line) {
  std::string& first = level <= AV_LOG_ERROR ? first_error_ : first_warning_;
  if (first.empty()) first = line;
}

}  // namespace touchline::hal::ffmpeg
