#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

namespace touchline::hal {

/// Writes text to standard output and error from a thread of its own, so that neither a stopped terminal (Ctrl-S) nor a
/// reader that does not read (a hung ssh, a full pipe) blocks the caller. The thread is never joined: it may wait in
/// write() for as long as the process lives, and it ends with the process. Any thread except the loop's may call it,
/// because it locks and allocates.
class TextOutput {
 public:
  /// Limit of waiting text, so that a day of status lines does not fill the memory; it is reached only if the reader
  /// does not read. Beyond it, the oldest texts are dropped and counted.
  static constexpr std::size_t kMaxWaitingBytes = std::size_t{256} << 10;
  /// Time limit of finish() at the end of a program. In this time a working terminal takes all 256 KiB (a few
  /// milliseconds), and a serial console of 115200 baud takes the last lines.
  static constexpr std::chrono::milliseconds kPatience{1000};

  /// Starts the thread, which inherits the priority of this one. The descriptors must stay open.
  explicit TextOutput(int out = 1, int err = 2);
  /// Calls finish(kPatience), unless a finish() has already failed.
  ~TextOutput();
  TextOutput(const TextOutput&) = delete;
  TextOutput& operator=(const TextOutput&) = delete;

  /// Returns at once. The texts are written in the order of the calls, even to different descriptors. If there is no
  /// memory, the text is lost.
  void print(std::string text);
  void print_error(std::string text);
  /// Waits until everything is written, `at_most` this long. Returns false if the reader does not read.
  bool finish(std::chrono::milliseconds at_most);

 private:
  struct State;
  void add(int descriptor, std::string text);
  static void work(const std::shared_ptr<State>& state);

  int out_, err_;
  bool has_reader_ = true;
  std::shared_ptr<State> state_;  // state shared with the thread, which may outlive this object
};

}  // namespace touchline::hal
