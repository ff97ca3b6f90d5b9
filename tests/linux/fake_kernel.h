#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/time.h"

// A fake kernel below the code under test, linked with `-Wl,--wrap=open,--wrap=ioctl,...`. It provides files below
// /dev, the clock and sleeping; all other files are the real ones. Time is virtual: it only advances while the code
// sleeps or waits, and by a microsecond for each read of the clock. Thus tests neither wait nor depend on the machine,
// and a loop that polls the clock reaches its deadline.
namespace touchline::fake {

/// The driver of a device file. Calls return 0 (or a value) or a negative errno, as in the kernel.
class File {
 public:
  virtual ~File() = default;
  virtual int open() { return 0; }
  /// Returns true if it may be opened without O_NONBLOCK, because its calls never wait.
  [[nodiscard]] virtual bool never_blocks() const { return false; }
  virtual void close() {}
  virtual int ioctl(unsigned long request, void* argument) = 0;
  /// Returns the current events for poll(), and the time at which they may change (Instant::max(): never).
  virtual short events() { return 0; }
  virtual Instant next_event() { return Instant::max(); }
  /// Returns null for EINVAL.
  virtual void* map(std::size_t length, long offset, int protection);
  /// Returns false if the memory does not belong to this file.
  virtual bool unmap(void* memory);
  virtual int lock() { return 0; }
};

/// Replaces the kernel during its lifetime. There may be only one at a time.
class Kernel {
 public:
  Kernel();
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  void add(const std::string& path, File& file) { files_[path] = &file; }
  void remove(const std::string& path) { files_.erase(path); }
  void refuse_open(const std::string& path, int error) { refusals_[path] = error; }
  void link(const std::string& from, const std::string& to) { links_[from] = to; }
  void unlink(const std::string& from) { links_.erase(from); }
  /// Makes the next waits and sleeps, or requests, fail with EINTR, as after a signal.
  void interrupt_waits(int times) { interrupted_waits_ = times; }
  void interrupt_requests(int times) { interrupted_requests_ = times; }
  /// Uses the real clock, for code whose threads wait for each other.
  void use_real_clock() { has_clock_ = false; }
  [[nodiscard]] bool has_clock() const { return has_clock_; }

  [[nodiscard]] Instant now() const { return now_; }
  void advance(Duration duration) { now_ += duration; }
  [[nodiscard]] std::size_t open_files() const { return open_.size(); }

  // Entry points of the wrapped functions.
  int open(const char* path, int flags);
  bool close(int number);
  File* file(int number);
  /// Registers a file that was opened by other means, such as a serial port. Returns its descriptor.
  int adopt(File& file);
  bool unmap(void* memory);
  int wait(File& file, short events, Instant deadline, short& found);
  /// Returns true while interruptions are left, and counts them down.
  bool wait_is_interrupted() { return interrupted_waits_ > 0 && interrupted_waits_-- > 0; }
  bool request_is_interrupted() { return interrupted_requests_ > 0 && interrupted_requests_-- > 0; }
  Instant read_clock();
  const std::string* resolve(const std::string& path) const;
  /// Returns the files and links whose names begin with `prefix`, except those in subfolders.
  [[nodiscard]] std::vector<std::string> names_with(const std::string& prefix) const;

 private:
  std::map<std::string, File*> files_;
  std::map<std::string, int> refusals_;
  std::map<std::string, std::string> links_;
  std::map<int, File*> open_;
  int next_number_ = 10000;  // higher than all real descriptors
  int interrupted_waits_ = 0, interrupted_requests_ = 0;
  bool has_clock_ = true;
  Instant now_{std::chrono::seconds(1000)};
};

/// Returns the current fake kernel, null if there is none.
Kernel* kernel();

}  // namespace touchline::fake
