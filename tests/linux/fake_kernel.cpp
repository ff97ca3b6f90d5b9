#include "tests/linux/fake_kernel.h"

#include <fcntl.h>
#include <glob.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "tests/linux/driver_allocations.h"

namespace touchline::fake {
namespace {

Kernel* current = nullptr;

Instant instant_of(const std::timespec& time) {
  return Instant(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

/// Kernel convention to C convention.
int to_c_result(int result) {
  if (result >= 0) return result;
  errno = -result;
  return -1;
}

}  // namespace

Kernel* kernel() { return current; }

void* File::map(std::size_t, long, int) { return nullptr; }
bool File::unmap(void*) { return false; }

Kernel::Kernel() { current = this; }
Kernel::~Kernel() { current = nullptr; }

int Kernel::open(const char* path, int flags) {
  if (const auto refusal = refusals_.find(path); refusal != refusals_.end()) return -refusal->second;
  const std::string* const target = resolve(path);
  if (target == nullptr) return -ENOENT;
  const auto found = files_.find(*target);
  const bool waits = (flags & O_NONBLOCK) == 0 && !found->second->never_blocks();
  if (waits || (flags & O_CLOEXEC) == 0) return -EINVAL;  // the drivers must set both flags
  if (const int result = found->second->open(); result < 0) return result;
  return adopt(*found->second);
}

int Kernel::adopt(File& file) {
  open_[next_number_] = &file;
  return next_number_++;
}

bool Kernel::close(int number) {
  const auto found = open_.find(number);
  if (found == open_.end()) return false;
  found->second->close();
  open_.erase(found);
  return true;
}

File* Kernel::file(int number) {
  const auto found = open_.find(number);
  return found == open_.end() ? nullptr : found->second;
}

bool Kernel::unmap(void* memory) {
  const auto unmaps = [&](const auto& entry) { return entry.second->unmap(memory); };
  return std::any_of(files_.begin(), files_.end(), unmaps) || std::any_of(open_.begin(), open_.end(), unmaps);
}

int Kernel::wait(File& file, short events, Instant deadline, short& found) {
  if (wait_is_interrupted()) return -EINTR;
  for (;;) {
    found = static_cast<short>(file.events() & (events | POLLERR | POLLHUP));
    if (found != 0) return 1;
    if (now() >= deadline) return 0;
    now_ = std::min(deadline, std::max(file.next_event(), now() + Duration(1)));
  }
}

Instant Kernel::read_clock() {
  advance(std::chrono::microseconds(1));
  return now();
}

const std::string* Kernel::resolve(const std::string& path) const {
  if (const auto link = links_.find(path); link != links_.end()) return resolve(link->second);
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->first;
}

std::vector<std::string> Kernel::names_with(const std::string& prefix) const {
  std::vector<std::string> found;
  const auto note = [&](const std::string& name) {
    if (name.rfind(prefix, 0) == 0 && name.find('/', prefix.size()) == std::string::npos) found.push_back(name);
  };
  for (const auto& [name, file] : files_) note(name);
  for (const auto& [from, to] : links_) note(from);
  return found;
}

}  // namespace touchline::fake

using touchline::fake::File;
using touchline::fake::kernel;
using touchline::testing::UncountedAllocations;

extern "C" {

int __real_open(const char* path, int flags, ...);
int __real_close(int number);
int __real_ioctl(int number, unsigned long request, ...);
void* __real_mmap(void* address, std::size_t length, int protection, int flags, int number, long offset);
int __real_munmap(void* memory, std::size_t length);
int __real_ppoll(pollfd* files, nfds_t count, const std::timespec* timeout, const sigset_t* mask);
int __real_clock_gettime(clockid_t clock, std::timespec* time);
int __real_clock_nanosleep(clockid_t clock, int flags, const std::timespec* time, std::timespec* left);
char* __real_realpath(const char* path, char* resolved);
int __real_glob(const char* pattern, int flags, int (*on_error)(const char*, int), glob_t* found);
int __real_flock(int number, int operation);
int __real_fcntl(int number, int command, ...);

int __wrap_open(const char* path, int flags, ...) {
  const UncountedAllocations uncounted;
  if (kernel() != nullptr && std::strncmp(path, "/dev/", 5) == 0) {
    return touchline::fake::to_c_result(kernel()->open(path, flags));
  }
  std::va_list arguments;
  va_start(arguments, flags);
  const int mode = va_arg(arguments, int);
  va_end(arguments);
  return __real_open(path, flags, mode);
}

int __wrap_close(int number) {
  const UncountedAllocations uncounted;
  if (kernel() != nullptr && kernel()->close(number)) return 0;
  return __real_close(number);
}

int __wrap_ioctl(int number, unsigned long request, ...) {
  const UncountedAllocations uncounted;
  std::va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  File* const file = kernel() != nullptr ? kernel()->file(number) : nullptr;
  if (file == nullptr) return __real_ioctl(number, request, argument);
  if (kernel()->request_is_interrupted()) return touchline::fake::to_c_result(-EINTR);
  return touchline::fake::to_c_result(file->ioctl(request, argument));
}

void* __wrap_mmap(void* address, std::size_t length, int protection, int flags, int number, long offset) {
  const UncountedAllocations uncounted;
  File* const file = kernel() != nullptr ? kernel()->file(number) : nullptr;
  if (file == nullptr) return __real_mmap(address, length, protection, flags, number, offset);
  void* const memory = file->map(length, offset, protection);
  if (memory != nullptr) return memory;
  errno = EINVAL;
  return MAP_FAILED;
}

int __wrap_munmap(void* memory, std::size_t length) {
  const UncountedAllocations uncounted;
  if (kernel() != nullptr && kernel()->unmap(memory)) return 0;
  return __real_munmap(memory, length);
}

int __wrap_ppoll(pollfd* files, nfds_t count, const std::timespec* timeout, const sigset_t* mask) {
  const UncountedAllocations uncounted;
  File* const file = kernel() != nullptr && count == 1 ? kernel()->file(files[0].fd) : nullptr;
  if (file == nullptr) return __real_ppoll(files, count, timeout, mask);
  const touchline::Instant deadline = kernel()->now() + touchline::fake::instant_of(*timeout).time_since_epoch();
  return touchline::fake::to_c_result(kernel()->wait(*file, files[0].events, deadline, files[0].revents));
}

int __wrap_clock_gettime(clockid_t clock, std::timespec* time) {
  const bool ours = kernel() != nullptr && kernel()->has_clock();
  if (!ours || clock != CLOCK_MONOTONIC) return __real_clock_gettime(clock, time);
  const auto now = kernel()->read_clock().time_since_epoch();
  time->tv_sec = static_cast<std::time_t>(std::chrono::duration_cast<std::chrono::seconds>(now).count());
  time->tv_nsec = static_cast<long>((now % std::chrono::seconds(1)).count());
  return 0;
}

int __wrap_clock_nanosleep(clockid_t clock, int flags, const std::timespec* time, std::timespec* left) {
  if (kernel() == nullptr) return __real_clock_nanosleep(clock, flags, time, left);
  if (clock != CLOCK_MONOTONIC || flags != TIMER_ABSTIME) return EINVAL;  // relative sleeps drift
  if (kernel()->wait_is_interrupted()) return EINTR;
  kernel()->advance(std::max(touchline::fake::instant_of(*time) - kernel()->now(), touchline::Duration::zero()));
  return 0;
}

char* __wrap_realpath(const char* path, char* resolved) {
  const UncountedAllocations uncounted;
  if (kernel() == nullptr) return __real_realpath(path, resolved);
  const std::string* const target = kernel()->resolve(path);
  if (target != nullptr) return ::strdup(target->c_str());
  errno = ENOENT;
  return nullptr;
}

int __wrap_glob(const char* pattern, int flags, int (*on_error)(const char*, int), glob_t* found) {
  if (kernel() == nullptr) return __real_glob(pattern, flags, on_error, found);
  std::string prefix(pattern);
  prefix.pop_back();  // "*"
  const std::vector<std::string> links = kernel()->names_with(prefix);
  found->gl_pathc = links.size();
  found->gl_pathv = static_cast<char**>(std::calloc(links.size() + 1, sizeof(char*)));
  for (std::size_t i = 0; i < links.size(); ++i) found->gl_pathv[i] = ::strdup(links[i].c_str());
  return links.empty() ? GLOB_NOMATCH : 0;
}

int __wrap_flock(int number, int operation) {
  File* const file = kernel() != nullptr ? kernel()->file(number) : nullptr;
  return file == nullptr ? __real_flock(number, operation) : touchline::fake::to_c_result(file->lock());
}

int __wrap_fcntl(int number, int command, ...) {
  std::va_list arguments;
  va_start(arguments, command);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (kernel() != nullptr && kernel()->file(number) != nullptr) return 0;
  return __real_fcntl(number, command, argument);
}

}  // extern "C"
