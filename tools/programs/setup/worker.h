#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hal/result.h"
#include "tools/programs/setup/message_link.h"

namespace touchline::setup {

/// Long work in a process of its own: it can be cancelled at any moment, and neither a lack of memory nor a failed
/// assertion in a library ends the program. It has no capabilities, and can get none.
class Worker {
 public:
  /// What the work uses to report.
  class Reporter {
   public:
    explicit Reporter(int descriptor) : descriptor_(descriptor) {}
    /// `share`: 0 to 1, less than 0: unknown.
    void progress(std::string_view text, double share = -1) const;
    /// Any message; `content` has "type".
    void send(const nlohmann::json& content, std::string_view bytes = {}) const;

   private:
    int descriptor_;
  };
  using Work = std::function<Result<void>(const Reporter&)>;

  Worker() = default;
  ~Worker() { cancel(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Starts the work. Its messages arrive at link(), at last {"type": "done", "error": ""}. kIo: no further process.
  Result<void> start(const Work& work);
  [[nodiscard]] bool is_running() const { return process_ > 0; }
  [[nodiscard]] MessageLink& link() { return link_; }
  /// After "done", or if the link has closed before: waits for the end of the process. Says how it ended; "" if well.
  std::string finish();
  /// Ends the process at once, if there is one.
  void cancel();

 private:
  pid_t process_ = 0;
  MessageLink link_;
};

}  // namespace touchline::setup
