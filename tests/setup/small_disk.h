#pragma once

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

// A small disk for a test, which can be full, or have files that cannot be replaced.
namespace touchline::setup {

inline constexpr int kNoNamespaces = 77, kTestFailed = 1;

// Mounts a small file system that only this process sees. Returns false if the kernel does not permit it.
inline bool mount_small_disk(const std::string& folder, std::size_t bytes) {
  const uid_t user = ::geteuid();
  const gid_t group = ::getegid();
  if (::unshare(user == 0 ? CLONE_NEWNS : CLONE_NEWNS | CLONE_NEWUSER) != 0) return false;
  if (user != 0) {
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
    std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
  }
  const std::string size = "size=" + std::to_string(bytes);
  return ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         ::mount("tmpfs", folder.c_str(), "tmpfs", 0, size.c_str()) == 0;
}

// Runs `test` in a process of its own, with a small disk at `folder`. Returns false if the kernel does not permit it.
template <class Test>
bool on_small_disk(const std::string& folder, std::size_t bytes, Test test) {
  const auto run = [&] {
    if (!mount_small_disk(folder, bytes)) ::_exit(kNoNamespaces);
    test();
    std::fflush(nullptr);  // print what failed
    ::_exit(::testing::Test::HasFailure() ? kTestFailed : 0);
  };
  bool is_permitted = true;
  const auto succeeded = [&is_permitted](int status) {
    is_permitted = !::testing::ExitedWithCode(kNoNamespaces)(status);
    return !is_permitted || ::testing::ExitedWithCode(0)(status);
  };
  EXPECT_EXIT(run(), succeeded, "");
  return is_permitted;
}

}  // namespace touchline::setup
