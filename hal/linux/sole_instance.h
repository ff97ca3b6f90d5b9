#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace touchline::hal {

/// An object of which there may be one at a time in a process: made for its first user, shared by all, destroyed with
/// the last one. Who comes while it is being destroyed waits and gets a new one.
template <class T>
class SoleInstance {
 public:
  /// `make` gives a std::unique_ptr<T>, null when it fails: then null, and there is nothing to be given back.
  template <class Make>
  T* take(const Make& make) {
    const std::scoped_lock alone(mutex_);
    if (users_ == 0) instance_ = make();
    if (instance_ != nullptr) ++users_;
    return instance_.get();
  }
  /// Once for each take() that was not null.
  void give_back() {
    const std::scoped_lock alone(mutex_);
    if (--users_ == 0) instance_.reset();
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<T> instance_;
  std::size_t users_ = 0;
};

}  // namespace touchline::hal
