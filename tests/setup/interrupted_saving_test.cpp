#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>

#include "tests/results.h"
#include "tests/setup/killed_process.h"
#include "tests/setup/small_disk.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/setup/saving.h"
#include "tools/programs/setup/saving_journal.h"

// A save that is killed at any of its steps.
namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

class InterruptedSaving : public touchline::testing::ProgramFolder {
 protected:
  InterruptedSaving() : before_(files("before")), after_(files("after")) {
    after_.content["venue-light-2.png"] = after_.content["venue-light.png"];  // a new file
    for (const auto& [name, content] : after_.content) names_.push_back(name);
    // The folder is in memory if possible, because hundreds of saves would wait for the disk otherwise.
    disk_ = fs::exists("/dev/shm") ? "/dev/shm/touchline_saving_" + std::to_string(::getpid()) : path("disk");
    fs::create_directories(disk_);
  }
  ~InterruptedSaving() override { fs::remove_all(disk_); }

  static SetupFiles files(const std::string& name) {
    SetupFiles out{"board.toml", "venue.toml", "team.toml", {}};
    const auto add = [&](const char* file, const std::string& text) {
      out.content[file] = std::make_shared<const std::string>(text);
    };
    add("board.toml", "name = \"" + name + "\"\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n");
    add("venue.toml", "[light]\nmap = \"venue-light.png\"\n# " + name + "\n");
    add("team.toml", "# " + name + "\n");
    add("venue-light.png", std::string("\x89PNG\0\xff\x00\x01", 8) + name);
    return out;
  }
  [[nodiscard]] std::string etc() const { return disk_ + "/etc"; }
  [[nodiscard]] std::string journal() const { return disk_ + "/state/saving.json"; }
  void begin() const {
    for (const char* folder : {"/etc", "/state"}) {
      fs::remove_all(disk_ + folder);
      fs::create_directory(disk_ + folder);
    }
    for (const auto& [name, content] : before_.content) put(name, *content);
  }
  void put(const std::string& name, const std::string& text) const { std::ofstream(etc() + "/" + name) << text; }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream file(etc() + "/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] Result<void> save() const { return save_files(after_, names_, etc(), journal()); }
  // Calls `test` after each step at which a save can be killed. Returns the number of steps.
  int after_each_kill(const std::function<void()>& begin_save, const std::function<void()>& test) const {
    Killed killed = Killed::kYes;
    int number = 0;
    for (; killed == Killed::kYes && !HasFailure(); ++number) {
      SCOPED_TRACE("killed at change " + std::to_string(number));
      begin_save();
      killed = kill_at_change(number, [this] { static_cast<void>(save().ok()); });
      if (killed == Killed::kNotPermitted) break;
      test();
    }
    return number;
  }
  // Kills a save when its journal is complete and no file is replaced yet. Returns the step at which it was killed; -1:
  // not permitted.
  int kill_at_first_rename(int first_step = 0) const {
    for (int number = first_step;; ++number) {
      begin();
      const Killed killed = kill_at_change(number, [this] { static_cast<void>(save().ok()); });
      if (killed != Killed::kYes) return -1;
      if (fs::exists(journal())) return number;
    }
  }
  // Plays what a person does before the next start, from the state that the kill has left. Returns the files that the
  // next start has left as they are.
  [[nodiscard]] std::vector<std::string> finish_after(const std::function<void()>& person) const {
    const std::string copy = disk_ + "-killed";
    fs::copy(disk_, copy, fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(disk_)) {  // a copy has the time of the copy
      fs::last_write_time(copy + entry.path().string().substr(disk_.size()), fs::last_write_time(entry.path()));
    }
    person();
    const Result<std::vector<std::string>> left = finish_saving(journal());
    EXPECT_TRUE(left.ok()) << left.text();
    EXPECT_FALSE(fs::exists(journal()));
    for (const auto& entry : fs::directory_iterator(etc())) {
      const bool was_begun = fs::exists(copy + "/state/saving.json");
      EXPECT_FALSE(was_begun && entry.path().extension() == ".part") << entry.path() << " is left over";
    }
    const std::string finished = disk_ + "-finished";
    fs::remove_all(finished);
    fs::rename(disk_, finished);
    fs::rename(copy, disk_);
    return left.ok() ? left.value() : std::vector<std::string>();
  }
  // To be called after finish_after().
  [[nodiscard]] std::string finished(const std::string& name) const {
    std::ifstream file(disk_ + "-finished/etc/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] bool has(const SetupFiles& files, const std::string& name) const {
    return fs::exists(disk_ + "-finished/etc/" + name) == (files.content.count(name) > 0) &&
           finished(name) == files.text(name);
  }
  [[nodiscard]] bool has_all(const SetupFiles& files) const {
    return std::all_of(names_.begin(), names_.end(), [&](const std::string& name) { return has(files, name); });
  }

  SetupFiles before_, after_;
  std::vector<std::string> names_;
  std::string disk_;
};

TEST_F(InterruptedSaving, ChangesAllFilesOrNoneAndNeverWhatAPersonWroteSince) {
  int forward = 0, back = 0, kept = 0;
  const int steps = after_each_kill(
      [this] { begin(); },
      [&] {
        EXPECT_TRUE(finish_after([] {}).empty());
        EXPECT_TRUE(has_all(before_) || has_all(after_));
        ++(has_all(after_) ? forward : back);

        for (const std::string& name : names_) {
          SCOPED_TRACE(name + " was written by hand");
          const std::vector<std::string> left = finish_after([&] { put(name, "# by hand\n"); });
          EXPECT_EQ(finished(name), "# by hand\n");
          for (const std::string& path : left) EXPECT_EQ(path, etc() + "/" + name);
          kept += static_cast<int>(left.size());
        }
        // Every byte equals the file before the save, but the file is the person's.
        if (content("board.toml") != after_.text("board.toml")) return;
        static_cast<void>(finish_after([&] {
          for (const auto& [name, text] : before_.content)
            fs::copy_file(etc() + "/" + name + ".bak", etc() + "/" + name, fs::copy_options::overwrite_existing);
        }));
        for (const auto& [name, text] : before_.content) EXPECT_TRUE(has(before_, name)) << name << " was put back";
      });
  if (steps == 1) GTEST_SKIP() << "processes cannot be traced here";
  EXPECT_GT(back, 20) << "steps before the journal";
  EXPECT_GT(forward, static_cast<int>(names_.size()));
  EXPECT_GT(kept, static_cast<int>(names_.size())) << "files that a save would have replaced";
}

// The start that finishes a save can be killed, too.
TEST_F(InterruptedSaving, CanBeFinishedByAnyLaterStart) {
  if (kill_at_first_rename() < 0) GTEST_SKIP() << "processes cannot be traced here";
  int number = 0;
  while (fs::exists(journal()) && number < 20) {
    static_cast<void>(kill_at_change(number++, [this] { static_cast<void>(finish_saving(journal()).ok()); }));
  }
  EXPECT_GT(number, static_cast<int>(names_.size()) / 2) << "renames, each done by another start";
  EXPECT_TRUE(finish_after([] {}).empty());
  EXPECT_TRUE(has_all(after_));
}

TEST_F(InterruptedSaving, IsFinishedHoweverLargeItsFilesAre) {
  const int step = kill_at_first_rename();
  after_.content["venue-light.png"] = std::make_shared<const std::string>(std::string(std::size_t{3} << 20, 'x'));
  if (step < 0 || kill_at_first_rename(step) < 0) GTEST_SKIP() << "processes cannot be traced here";
  EXPECT_TRUE(finish_after([] {}).empty());
  EXPECT_TRUE(has_all(after_));
}

// The kernel refuses to rename over a file on which another one is mounted: the files before it are restored.
TEST_F(InterruptedSaving, CanBeUndoneAtAnyStepToo) {
  const bool is_permitted = on_small_disk(disk_, std::size_t{4} << 20, [this] {
    const std::string busy = etc() + "/venue.toml";
    int partly = 0;
    const auto begin_save = [&] {
      begin();
      ASSERT_EQ(::mount(busy.c_str(), busy.c_str(), nullptr, MS_BIND, nullptr), 0);
    };
    const auto has_some = [&](const SetupFiles& files) {
      return std::any_of(names_.begin(), names_.end(),
                         [&](const std::string& name) { return content(name) == files.text(name); });
    };
    const int steps = after_each_kill(begin_save, [&] {
      ASSERT_EQ(::umount(busy.c_str()), 0);
      partly += has_some(before_) && has_some(after_) ? 1 : 0;
      ASSERT_TRUE(finish_saving(journal()).ok());
      bool all_before = true, all_after = true;
      for (const std::string& name : names_) {
        const bool exists = fs::exists(etc() + "/" + name);
        all_before = all_before && exists == (before_.content.count(name) > 0) && content(name) == before_.text(name);
        all_after = all_after && content(name) == after_.text(name);
      }
      EXPECT_TRUE(all_before || all_after);
    });
    if (steps > 1) {
      EXPECT_GT(partly, 10);
    }
  });
  if (!is_permitted) GTEST_SKIP() << "mount namespaces are not permitted here";
}

TEST_F(InterruptedSaving, AJournalThatCannotBeReadIsReportedAndRemoved) {
  begin();
  for (const std::string text : {"{\"half\": ", "{}", "[1]", "{\"format\": \"touchline-setup\", \"version\": 1}"}) {
    std::ofstream(journal()) << text;
    const Result<std::vector<std::string>> finished = finish_saving(journal());
    EXPECT_EQ(finished.code(), ErrorCode::kInconsistent);
    EXPECT_NE(finished.text().find("compare the saved files with their .bak"), std::string::npos) << finished.text();
    EXPECT_FALSE(fs::exists(journal()));
  }
  EXPECT_TRUE(finish_saving(journal()).ok()) << "nothing to do";
}

}  // namespace
}  // namespace touchline::setup
