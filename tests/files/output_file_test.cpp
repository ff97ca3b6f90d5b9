// Output files appear complete or not at all. Links, devices and other files are respected.
#include "hal/files/output_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>

#include <csignal>
#include <thread>

#include "tests/files/temporary_folder.h"

namespace touchline::hal {
namespace {

using testing::TemporaryFolder;

Result<void> write(const std::string& path, const std::string& text, const OutputOptions& options = {}) {
  Result<void> written = write_file(path, text, options);
  EXPECT_TRUE(written.ok()) << written.text();
  return written;
}

std::string write_refusal(const std::string& path, ErrorCode code) {
  const Result<void> written = write_file(path, "text");
  EXPECT_EQ(written.code(), code) << written.text();
  return written.text();
}

TEST(OutputFile, ANewFileAppearsWithCommit) {
  const TemporaryFolder folder;
  OutputFile file;
  ASSERT_TRUE(file.open(folder / "a").ok());
  ASSERT_TRUE(file.write("one ").ok() && file.write("two").ok());
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  ASSERT_TRUE(file.commit().ok());
  EXPECT_EQ(folder.read("a"), "one two");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, WithoutCommitTheFormerFileStaysAndNothingIsLeft) {
  const TemporaryFolder folder;
  folder.write("a", "former");
  {
    OutputFile file;
    ASSERT_TRUE(file.open(folder / "a").ok() && file.write("new").ok());
    EXPECT_EQ(folder.count(), 2U) << "the temporary file is in the same folder";
  }
  EXPECT_EQ(folder.read("a"), "former");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, AKilledProcessLeavesTheFormerFile) {
  const TemporaryFolder folder;
  folder.write("a", "former");
  const pid_t child = ::fork();
  if (child == 0) {
    OutputFile file;
    if (file.open(folder / "a").ok() && file.write(std::string(1 << 20, 'x')).ok()) ::raise(SIGKILL);
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(folder.read("a"), "former");
}

TEST(OutputFile, WritesLongFilesAndSeeks) {
  const TemporaryFolder folder;
  OutputFile file;
  ASSERT_TRUE(file.open(folder / "a").ok());
  std::string expected;
  for (int i = 0; i < 300; ++i) {
    const std::string part(static_cast<std::size_t>(997 * (i % 7)), static_cast<char>('a' + i % 26));
    ASSERT_TRUE(file.write(part).ok());
    expected += part;
  }
  const std::string large(200000, '.');
  ASSERT_TRUE(file.write(large).ok());
  expected += large;
  ASSERT_TRUE(file.seek(10).ok() && file.write("HERE").ok() && file.commit().ok());
  expected.replace(10, 4, "HERE");
  EXPECT_TRUE(folder.read("a") == expected);
}

TEST(OutputFile, KeepsPermissionsAndObeysTheUmask) {
  const TemporaryFolder folder;
  folder.write("a", "former");
  ::chmod((folder / "a").c_str(), 0640);
  const mode_t umask = ::umask(027);
  EXPECT_TRUE(write(folder / "a", "new").ok());
  EXPECT_TRUE(write(folder / "b", "new").ok());
  EXPECT_TRUE(write(folder / "c", "new", {.mode = 0604}).ok());
  ::umask(umask);
  EXPECT_EQ(folder.mode("a"), mode_t{S_IFREG | 0640});
  EXPECT_EQ(folder.mode("b"), mode_t{S_IFREG | 0640});
  EXPECT_EQ(folder.mode("c"), mode_t{S_IFREG | 0604});
}

TEST(OutputFile, ALinkStaysALink) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  folder.write("sub/target", "former");
  std::filesystem::create_symlink("sub/target", folder / "inner");
  std::filesystem::create_symlink(folder / "inner", folder / "link");
  EXPECT_TRUE(write(folder / "link", "new").ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "inner"));
  EXPECT_EQ(folder.read("sub/target"), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "sub/target"));

  std::filesystem::create_symlink("sub/later", folder / "dangling");
  EXPECT_TRUE(write(folder / "dangling", "created").ok());
  EXPECT_EQ(folder.read("sub/later"), "created");
}

TEST(OutputFile, ReplacesALinkIfFollowLinksIsFalse) {
  const TemporaryFolder folder;
  folder.write("precious", "keep");
  std::filesystem::create_symlink("precious", folder / "link");
  EXPECT_TRUE(write(folder / "link", "new", {.follow_links = false}).ok());
  EXPECT_EQ(folder.mode("link") & S_IFMT, mode_t{S_IFREG});
  EXPECT_EQ(folder.read("precious"), "keep");
}

TEST(OutputFile, ALoopOfLinksIsReported) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  EXPECT_EQ(write_refusal(folder / "a", ErrorCode::kIo),
            folder / "a: cannot be written: Too many levels of symbolic links");
}

TEST(OutputFile, AFifoIsWrittenInPlace) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] { received = folder.read("fifo"); });
  OutputFile file;
  EXPECT_TRUE(file.open(folder / "fifo").ok());
  EXPECT_FALSE(file.replaces_file());
  EXPECT_EQ(file.seek(0).code(), ErrorCode::kUnsupported);
  EXPECT_TRUE(file.write("through the pipe").ok() && file.commit().ok());
  reader.join();
  EXPECT_EQ(received, "through the pipe");
  EXPECT_EQ(folder.mode("fifo") & S_IFMT, mode_t{S_IFIFO});
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, ACharacterDeviceStaysOne) {
  const TemporaryFolder folder;
  if (::mknod((folder / "null").c_str(), S_IFCHR | 0666, ::makedev(1, 3)) != 0) GTEST_SKIP() << "needs root";
  EXPECT_TRUE(write(folder / "null", "into the void").ok());
  EXPECT_EQ(folder.mode("null") & S_IFMT, mode_t{S_IFCHR});
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, AFullDeviceIsAnError) {
  EXPECT_EQ(write_refusal("/dev/full", ErrorCode::kIo), "/dev/full: cannot be written: No space left on device");
}

TEST(OutputFile, AFullDiskLeavesTheFormerFile) {
  const TemporaryFolder folder;
  folder.write("a", "former");
  const pid_t child = ::fork();  // the limit applies to a process
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    const bool limited = ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
    const Result<void> written = write_file(folder / "a", std::string(5000, 'x'));
    ::_exit(limited && written.text() == folder / "a: cannot be written: File too large" ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(folder.read("a"), "former");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, ADashIsStandardOutput) {
  ::testing::internal::CaptureStdout();
  EXPECT_TRUE(write("-", "to the terminal\n").ok());
  EXPECT_TRUE(write("/dev/stdout", "again\n").ok());
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "to the terminal\nagain\n");
}

TEST(OutputFile, OtherFilesInTheFolderAreNotChanged) {
  const TemporaryFolder folder;
  for (const char* name : {"a.part", "a.new", "a.tmp"}) folder.write(name, "somebody else's");
  EXPECT_TRUE(write(folder / "a", "new").ok());
  for (const char* name : {"a.part", "a.new", "a.tmp"}) EXPECT_EQ(folder.read(name), "somebody else's");
}

TEST(OutputFile, FoldersAndMissingFoldersAreReported) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_refusal(folder.path(), ErrorCode::kIo),
            folder.path().string() + ": is a folder, not a file to write");
  EXPECT_EQ(write_refusal(folder / "a/", ErrorCode::kIo), folder / "a/: is a folder, not a file to write");
  EXPECT_EQ(write_refusal(folder / "none/a", ErrorCode::kNotFound),
            folder / "none/a: cannot be created: No such file or directory");
  folder.write("file", "");
  EXPECT_EQ(write_refusal(folder / "file/a", ErrorCode::kNotFound),
            folder / "file/a: cannot be written: Not a directory");
}

TEST(OutputFile, AWriteProtectedFileIsNotReplaced) {
  const TemporaryFolder folder;
  folder.write("a", "former");
  ::chmod((folder / "a").c_str(), 0444);
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everything";
  EXPECT_EQ(write_refusal(folder / "a", ErrorCode::kPermission), folder / "a: cannot be written: Permission denied");
  EXPECT_EQ(folder.read("a"), "former");
}

TEST(OutputFile, NamesMayHaveTheMaximumLength) {
  const TemporaryFolder folder;
  const std::string name(255, 'n');
  EXPECT_TRUE(write(folder / name, "new").ok());
  EXPECT_EQ(folder.read(name), "new");
}

}  // namespace
}  // namespace touchline::hal
