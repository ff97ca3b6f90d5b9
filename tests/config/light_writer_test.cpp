// Light map and venue file stay consistent if the process ends at any step or a system call fails.
#include "firmware/config/light_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <optional>

#include "tests/files/temporary_folder.h"

namespace {

// Counts the system calls that change files. At one of them, the process ends or the call fails.
struct Injection {
  int calls = 0;
  int at = 0;     // 0: never
  int error = 0;  // 0: the process ends, without any clean-up
  bool fired = false;
};
Injection injection;

bool fails() {
  if (++injection.calls != injection.at) return false;
  injection.fired = true;
  if (injection.error == 0) ::_exit(9);
  errno = injection.error;
  return true;
}

}  // namespace

// The linker replaces the system calls by these functions (--wrap).
extern "C" {
int __real_openat(int folder, const char* path, int flags, ...);
ssize_t __real_write(int file, const void* bytes, std::size_t size);
int __real_fchmod(int file, mode_t mode);
int __real_fsync(int file);
int __real_renameat(int from_folder, const char* from, int to_folder, const char* to);
int __real_unlinkat(int folder, const char* path, int flags);
int __wrap_openat(int folder, const char* path, int flags, ...);
ssize_t __wrap_write(int file, const void* bytes, std::size_t size);
int __wrap_fchmod(int file, mode_t mode);
int __wrap_fsync(int file);
int __wrap_renameat(int from_folder, const char* from, int to_folder, const char* to);
int __wrap_unlinkat(int folder, const char* path, int flags);

int __wrap_openat(int folder, const char* path, int flags, ...) {
  std::va_list list;
  va_start(list, flags);
  const mode_t mode = va_arg(list, mode_t);
  va_end(list);
  return fails() ? -1 : __real_openat(folder, path, flags, mode);
}
ssize_t __wrap_write(int file, const void* bytes, std::size_t size) {
  return fails() ? -1 : __real_write(file, bytes, size);
}
int __wrap_fchmod(int file, mode_t mode) { return fails() ? -1 : __real_fchmod(file, mode); }
int __wrap_fsync(int file) { return fails() ? -1 : __real_fsync(file); }
int __wrap_renameat(int from_folder, const char* from, int to_folder, const char* to) {
  return fails() ? -1 : __real_renameat(from_folder, from, to_folder, to);
}
int __wrap_unlinkat(int folder, const char* path, int flags) {
  return fails() ? -1 : __real_unlinkat(folder, path, flags);
}
}

namespace touchline::config {
namespace {

LightEntry entry_of(float normal) {
  LightEntry entry;
  entry.surface = "grey";
  entry.normal = {normal, normal, normal};
  return entry;
}

class LightWriter : public ::testing::Test {
 protected:
  // The content of a map is the value of its `normal`.
  static Result<std::string> write(const testing::TemporaryFolder& folder, int number) {
    return write_light(folder / "venue.toml", std::to_string(number), entry_of(static_cast<float>(number)));
  }
  static void prepare(const testing::TemporaryFolder& folder) {
    injection = {};
    folder.write("venue.toml", "version = 1\n\n[picture]\nwidth_px = 640\n");
    for (int number : {100, 101}) {
      const Result<std::string> written = write(folder, number);
      ASSERT_TRUE(written.ok()) << written.text();
    }
  }
  /// Returns the value of `normal` in a venue file if its map belongs to it; otherwise nothing.
  static std::optional<int> number_of(const testing::TemporaryFolder& folder, const std::string& venue) {
    const std::string text = folder.read(venue);
    const auto value = [&text](const std::string& key, const char* end) {
      const std::size_t begin = text.find(key) + key.size();
      return text.substr(begin, text.find_first_of(end, begin) - begin);
    };
    const std::string normal = value("normal = [", "."), map = folder.read(value("map = \"", "\""));
    return normal == map && !normal.empty() ? std::optional<int>(std::stoi(normal)) : std::nullopt;
  }
};

TEST_F(LightWriter, AlternatesBetweenTwoMaps) {
  const testing::TemporaryFolder folder;
  prepare(folder);
  EXPECT_NE(folder.read("venue.toml").find("map = \"venue-light-2.png\""), std::string::npos);
  const Result<std::string> third = write(folder, 102);
  ASSERT_TRUE(third.ok()) << third.text();
  EXPECT_EQ(third.value(), folder / "venue-light.png");
  EXPECT_EQ(number_of(folder, "venue.toml"), 102);
  EXPECT_EQ(number_of(folder, "venue.toml.bak"), 101);
  EXPECT_NE(folder.read("venue.toml").find("width_px = 640"), std::string::npos);
  EXPECT_EQ(folder.count(), 4U) << "two venue files, two maps";
}

TEST_F(LightWriter, AKilledProcessLeavesAConsistentVenue) {
  int steps = 0;
  for (int at = 1;; ++at) {
    const testing::TemporaryFolder folder;
    prepare(folder);
    const pid_t child = ::fork();
    if (child == 0) {
      injection.at = at, injection.calls = 0;
      ::_exit(write(folder, 102).ok() ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    const std::optional<int> number = number_of(folder, "venue.toml");
    ASSERT_TRUE(number == 101 || number == 102) << "killed at call " << at;
    const std::optional<int> backup = number_of(folder, "venue.toml.bak");
    ASSERT_TRUE(backup == 100 || backup == 101) << "killed at call " << at;
    if (status == 0) {
      EXPECT_EQ(number, 102);
      break;
    }
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 9) << "at call " << at;
    ++steps;
  }
  EXPECT_GE(steps, 15) << "four files, each created, written, synced, renamed";
}

TEST_F(LightWriter, AFailedCallIsReportedAndLeavesAConsistentVenue) {
  int failures = 0;
  for (int at = 1;; ++at) {
    const testing::TemporaryFolder folder;
    prepare(folder);
    injection = {0, at, EIO, false};
    const Result<std::string> written = write(folder, 102);
    const bool fired = injection.fired;
    injection = {};
    const std::optional<int> number = number_of(folder, "venue.toml");
    if (!fired) {
      EXPECT_TRUE(written.ok()) << written.text();
      break;
    }
    ++failures;
    ASSERT_FALSE(written.ok()) << "the failure of call " << at << " was not noticed";
    // The message tells whether the venue file was replaced.
    const bool venue_replaced = written.text().starts_with(folder / "venue.toml: is replaced, but");
    ASSERT_EQ(number, venue_replaced ? 102 : 101) << "call " << at << ": " << written.text();
  }
  EXPECT_GE(failures, 15);
}

}  // namespace
}  // namespace touchline::config
