#pragma once

#include <functional>
#include <string>

#include "firmware/console/file_thread.h"

namespace touchline::console {

/// Body of an answer, and the name under which a browser stores it (without extension, "": not stored).
struct MadeAnswer {
  std::string name, bytes;
};

/// Makes slow answers, one at a time, on a thread of the lowest priority. Only the console's thread may use it.
class AnswerWorker {
 public:
  /// Returns whether an answer is being made or waits for take().
  [[nodiscard]] bool is_busy() const { return is_busy_; }
  /// Returns whether take() has an answer.
  [[nodiscard]] bool is_done();
  /// Call it only if it is not busy. `make` must own everything that it uses; if it throws, the answer is empty. Throws
  /// std::system_error if no thread can be started.
  void start(std::function<MadeAnswer()> make);
  /// Returns the answer; call it after is_done().
  MadeAnswer take();

 private:
  bool is_busy_ = false, is_done_ = false;
  MadeAnswer answer_;
  FileThread thread_{FileThread::Priority::kLowest};
};

}  // namespace touchline::console
