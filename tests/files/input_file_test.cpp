// Only regular files of a limited size are read, so no file can make a program wait.
#include "hal/files/input_file.h"

#include "tests/files/temporary_folder.h"

namespace touchline::hal {
namespace {

using testing::TemporaryFolder;

std::string refusal(const std::string& path, ErrorCode code, std::size_t limit_bytes = kMaxTextFileBytes) {
  const Result<std::string> bytes = read_file(path, limit_bytes);
  EXPECT_EQ(bytes.code(), code) << bytes.text();
  return bytes.text();
}

std::string content(const std::string& path, std::size_t limit_bytes = kMaxTextFileBytes) {
  const Result<std::string> bytes = read_file(path, limit_bytes);
  EXPECT_TRUE(bytes.ok()) << bytes.text();
  return bytes.ok() ? bytes.value() : std::string();
}

TEST(InputFile, ReadsRegularFiles) {
  const TemporaryFolder folder;
  folder.write("empty", "");
  EXPECT_EQ(content(folder / "empty"), "");
  const std::string text = std::string("line\0 and more\n", 15) + std::string(100000, 'x');
  folder.write("a", text);
  std::filesystem::create_symlink("a", folder / "link");
  EXPECT_EQ(content(folder / "link"), text);
  EXPECT_NE(content("/proc/self/status"), "") << "it reports a size of 0 bytes";
}

TEST(InputFile, TheLimitIsTheLargestSize) {
  const TemporaryFolder folder;
  folder.write("a", std::string(5000, 'x'));
  EXPECT_EQ(content(folder / "a", 5000).size(), 5000U);
  refusal(folder / "a", ErrorCode::kOutOfRange, 4999);
  refusal("/proc/self/status", ErrorCode::kOutOfRange, 100);
  folder.write("large", "");
  std::filesystem::resize_file(folder / "large", std::uintmax_t{1} << 40);  // a sparse file
  EXPECT_EQ(refusal(folder / "large", ErrorCode::kOutOfRange),
            folder / "large: is larger than 1 MiB, the limit for such a file");
}

TEST(InputFile, DevicesFifosAndFoldersAreRefusedWithoutWaiting) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal("/dev/zero", ErrorCode::kUnsupported), "/dev/zero: is a character device, not a file");
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(refusal(folder / "fifo", ErrorCode::kUnsupported), folder / "fifo: is a FIFO, not a file");
  EXPECT_EQ(refusal(folder.path(), ErrorCode::kUnsupported), folder.path().string() + ": is a folder, not a file");
}

TEST(InputFile, MissingFilesAndBrokenLinksAreReported) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal(folder / "none", ErrorCode::kNotFound), folder / "none: no such file");
  std::filesystem::create_symlink("gone", folder / "dangling");
  EXPECT_EQ(refusal(folder / "dangling", ErrorCode::kNotFound),
            folder / "dangling: is a symbolic link to gone, which does not exist");
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  EXPECT_EQ(refusal(folder / "a", ErrorCode::kIo), folder / "a: its symbolic links form a loop");
}

}  // namespace
}  // namespace touchline::hal
