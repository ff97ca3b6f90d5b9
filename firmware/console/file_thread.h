#pragma once

#include <functional>
#include <memory>

namespace touchline::console {

/// A thread for everything that may wait for a disk or a device. The console's thread passes on every stop, so it never
/// waits for them itself.
class FileThread {
 public:
  /// What the console's thread does with the result of a job.
  using Finish = std::function<void()>;
  /// Called on the file thread, one after the other. A job owns all that it uses: if the disk blocks, it may outlive
  /// this object. It throws nothing.
  using Job = std::function<Finish()>;
  enum class Priority { kNormal, kLowest };

  explicit FileThread(Priority priority = Priority::kNormal);
  /// Waits a moment for the job that runs; one that is blocked does not hold up the end of the program.
  ~FileThread();
  FileThread(const FileThread&) = delete;
  FileThread& operator=(const FileThread&) = delete;

  /// Queues a job. The caller keeps the number of its jobs small. The thread begins with the first one. Throws
  /// std::system_error if there is none.
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
