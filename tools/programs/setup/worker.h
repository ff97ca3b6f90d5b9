#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hal/result.h"
#include "tools/programs/setup/message_link.h"

namespace touchline::setup {

/// Runs long work in a process of its own: it can be canceled at any moment, and neither a lack of memory nor a failed
/// assertion in a library ends the program. The process has no capabilities, and can get none.
class Worker {
 public:
  /// Functions by which the work reports.
  class Reporter {
   public:
    explicit Reporter(int descriptor) : descriptor_(descriptor) {}
    /// `share`: 0 to 1, less than 0: unknown.
    void progress(std::string_view text, double share = -1) const;
    /// Sends any message; `content` must have "type".
    void send(const nlohmann::json& content, std::string_view bytes = {}) const;

   private:
    int descriptor_;
  };
  using Work = std::function<Result<void>(const Reporter&)>;

  Worker() = default;
  ~Worker() { cancel(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Starts the work. Its messages arrive at link(), at last {"type": "done", "error": ""}. kIo: no process could be
  /// started.
  Result<void> start(const Work& work);
  [[nodiscard]] bool is_running() const { return process_ > 0; }
  [[nodiscard]] MessageLink& link() { return link_; }
  /// Waits for the end of the process, after "done" or after the link has closed. Returns how it ended; "" if normally.
  std::string finish();
  /// Ends the process at once, if it is running.
  void cancel();

 private:
  pid_t process_ = 0;
  MessageLink link_;
};

}  // namespace touchline::setup
