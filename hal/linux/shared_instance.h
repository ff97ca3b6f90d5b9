#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace touchline::hal {

/// Shares an object that may exist only once in a process. The first user creates it, the last one destroys it. A user
/// that arrives during the destruction waits and gets a new object.
template <class T>
class SharedInstance {
 public:
  /// Returns the object; if there is none, creates it by `make`, which returns a std::unique_ptr<T>. If `make` returns
  /// null, returns null, and release() must not be called.
  template <class Make>
  T* acquire(const Make& make) {
    const std::scoped_lock alone(mutex_);
    if (users_ == 0) instance_ = make();
    if (instance_ != nullptr) ++users_;
    return instance_.get();
  }
  /// Call it once for each acquire() that did not return null.
  void release() {
    const std::scoped_lock alone(mutex_);
    if (--users_ == 0) instance_.reset();
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<T> instance_;
  std::size_t users_ = 0;
};

}  // namespace touchline::hal
