#pragma once

#include <functional>
#include <memory>

namespace touchline::console {

/// Niceness of threads that must not take the processor from others: the lowest priority of setpriority().
inline constexpr int kLowestNice = 19;

/// A thread for all work that may wait for a disk or a device. The console's thread passes on every stop, so it must
/// never wait for these itself.
class FileThread {
 public:
  /// Uses the result of a job, on the console's thread.
  using Finish = std::function<void()>;
  /// Work that is done on the file thread, one job after the other. A job must own everything that it uses, because it
  /// may outlive this object if the disk blocks. It must not throw.
  using Job = std::function<Finish()>;
  enum class Priority { kNormal, kLowest };

  explicit FileThread(Priority priority = Priority::kNormal);
  /// Waits a moment for the running job; a job that is blocked does not delay the end of the program.
  ~FileThread();
  FileThread(const FileThread&) = delete;
  FileThread& operator=(const FileThread&) = delete;

  /// Queues a job. The caller must keep the number of its jobs small. The first job starts the thread. Throws
  /// std::system_error if no thread can be started.
  void run(Job job);
  /// Calls the Finish of each job that has ended since the last call. Never waits.
  void finish();

 private:
  struct Shared;
  static void work(const std::shared_ptr<Shared>& shared, Priority priority);

  const Priority priority_;
  const std::shared_ptr<Shared> shared_;
};

}  // namespace touchline::console
