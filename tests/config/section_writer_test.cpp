// Replacing one section keeps all other bytes of the file.
#include "firmware/config/section_writer.h"

#include <sys/stat.h>

#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

std::string replaced(const std::string& text, std::string_view section, std::string_view toml) {
  const Result<std::string> out = replace_section(text, section, toml);
  EXPECT_TRUE(out.ok()) << out.text();
  return out.ok() ? out.value() : std::string();
}

TEST(SectionWriter, ReplacesOneSectionAndKeepsAllOtherBytes) {
  const std::string text =
      "# hall A\nversion = 1   # keep\n\n# the lens\n[camera_model]\nkind='full'  # odd   spacing\n"
      "[camera_model.full]\nfx_px = 1\n\n\n# light stays\n[light]\n  map = \"l.png\" # x\n";
  EXPECT_EQ(replaced(text, "camera_model", "[camera_model]\nkind = \"paper\"\n"),
            "# hall A\nversion = 1   # keep\n\n[camera_model]\nkind = \"paper\"\n"
            "\n\n# light stays\n[light]\n  map = \"l.png\" # x\n");
}

TEST(SectionWriter, CommentWithoutBlankLineBelongsToTheSectionAbove) {
  EXPECT_EQ(replaced("a.x = 1\n[b]\ny = 1\n# of b\n[c]\nz = 1\n", "c", "[c]\nz = 2\n"),
            "a.x = 1\n[b]\ny = 1\n# of b\n[c]\nz = 2\n");
  EXPECT_EQ(replaced("[b]\ny = 1\n# of b\n[c]\nz = 1\n", "b", "[b]\ny = 2\n"), "[b]\ny = 2\n[c]\nz = 1\n");
}

TEST(SectionWriter, ReplacesAllTablesOfAList) {
  const std::string text =
      "version = 1\n[[color]]\nname = \"a\"\n[[color.box]]\nlow = [1]\n\n[field]\nlength_m = 1.0\n\n[[color]]\n"
      "name = \"b\"\n[light]\nmap = \"\"\n";
  EXPECT_EQ(replaced(text, "color", "[[color]]\nname = \"c\"\n\n[[color]]\nname = \"d\"\n"),
            "version = 1\n[[color]]\nname = \"c\"\n\n[[color]]\nname = \"d\"\n\n[field]\nlength_m = 1.0\n\n"
            "[light]\nmap = \"\"\n");
}

TEST(SectionWriter, DistinguishesSectionsWithACommonPrefix) {
  EXPECT_EQ(replaced("[color]\na = 1\n[colors]\nb = 1\n", "color", "[color]\na = 2\n"),
            "[color]\na = 2\n[colors]\nb = 1\n");
}

TEST(SectionWriter, AppendsAMissingSection) {
  EXPECT_EQ(replaced("version = 1\n", "light", "[light]\nmap = \"m\"\n"), "version = 1\n\n[light]\nmap = \"m\"\n");
  EXPECT_EQ(replaced("version = 1", "light", "[light]\nmap = \"m\""), "version = 1\n\n[light]\nmap = \"m\"\n");
}

TEST(SectionWriter, LastSectionWithoutFinalLineEnd) {
  EXPECT_EQ(replaced("version = 1\n[light]\nmap = \"m\"", "light", "[light]\nmap = \"n\""),
            "version = 1\n[light]\nmap = \"n\"\n");
}

TEST(SectionWriter, KeepsWindowsLineEnds) {
  EXPECT_EQ(replaced("version = 1\r\n\r\n[a]\r\nx = 1\r\n[b]\r\ny = 1\r\n", "a", "[a]\nx = 2\n"),
            "version = 1\r\n\r\n[a]\r\nx = 2\r\n[b]\r\ny = 1\r\n");
  EXPECT_EQ(replaced("version = 1\r\n", "b", "[b]\ny = 1\n"), "version = 1\r\n\r\n[b]\r\ny = 1\r\n");
}

TEST(SectionWriter, IgnoresHeadersInsideValues) {
  const std::string text =
      "[a]\ntext = \"\"\"\n[b]\nno header\n\"\"\"\nlist = [\n  [1, 2],\n  [3]\n]\nquote = '[b]'  # [b]\n[b]\nx = 1\n";
  EXPECT_EQ(replaced(text, "b", "[b]\nx = 2\n"), text.substr(0, text.rfind("x = 1")) + "x = 2\n");
  const std::string literal = "[a]\ntext = '''\n[b]\n''''\n[b]\nx = 1\n";
  EXPECT_EQ(replaced(literal, "b", "[b]\nx = 2\n"), "[a]\ntext = '''\n[b]\n''''\n[b]\nx = 2\n");
}

TEST(SectionWriter, RemovesASection) {
  EXPECT_EQ(replaced("version = 1\n\n[a]\nx = 1\n\n[b]\ny = 1\n", "a", ""), "version = 1\n\n[b]\ny = 1\n");
  EXPECT_EQ(replaced("version = 1\n", "a", ""), "version = 1\n");
}

TEST(SectionWriter, RejectsFilesThatItCannotEdit) {
  const auto refusal = [](const std::string& text, std::string_view toml) {
    const Result<std::string> out = replace_section(text, "light", toml);
    EXPECT_EQ(out.code(), ErrorCode::kInconsistent);
    return out.text();
  };
  EXPECT_EQ(refusal("light = {map = \"m\"}\n", "[light]\nmap = \"n\"\n").substr(0, 69),
            "[light] is not written as a section with a header; rewrite it by hand");
  EXPECT_EQ(refusal("a = \n", "[light]\n").substr(0, 17), "the file, line 1:");
  EXPECT_EQ(refusal("", "[dark]\n"), "the new text must hold [light] and nothing else");
  EXPECT_EQ(refusal("", "[light\n").substr(0, 24), "the new section, line 1:");
}

TEST_F(ConfigFiles, SectionWriterKeepsABackup) {
  const std::string before = read(path("venue.toml"));
  ::chmod(path("venue.toml").c_str(), 0640);
  const Result<void> written = write_section(path("venue.toml"), "field", "[field]\nlength_m = 1.5\nwidth_m = 1.3\n");
  ASSERT_TRUE(written.ok()) << written.text();
  EXPECT_EQ(read(path("venue.toml.bak")), before);
  EXPECT_FALSE(std::filesystem::exists(path("venue.toml.new")));
  std::string after = before;
  after.replace(after.find("length_m = 2.2\nwidth_m = 1.8"), 28, "length_m = 1.5\nwidth_m = 1.3");
  EXPECT_EQ(read(path("venue.toml")), after);
  struct stat status {};
  ASSERT_EQ(::stat(path("venue.toml").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640U);
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->venue.field.length_m, 1.5f);
}

TEST_F(ConfigFiles, SectionWriterCreatesAFile) {
  const Result<void> written = write_section(path("new.toml"), "light", "[light]\nmap = \"m\"\n");
  ASSERT_TRUE(written.ok()) << written.text();
  EXPECT_EQ(read(path("new.toml")), "version = 1\n\n[light]\nmap = \"m\"\n");
  EXPECT_FALSE(std::filesystem::exists(path("new.toml.bak")));
}

TEST_F(ConfigFiles, SectionWriterKeepsALink) {
  std::filesystem::create_symlink("venue.toml", path("link.toml"));
  const Result<void> written = write_section(path("link.toml"), "light", "[light]\nmap = \"\"\n");
  ASSERT_TRUE(written.ok()) << written.text();
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.toml")));
  EXPECT_NE(read(path("venue.toml")).find("[light]"), std::string::npos);
}

TEST_F(ConfigFiles, SectionWriterDoesNotFollowAPlantedLink) {
  write("precious", "keep");
  for (const char* name : {"venue.toml.new", "venue.toml.bak"}) {
    std::filesystem::create_symlink("precious", path(name));
  }
  const Result<void> written = write_section(path("venue.toml"), "light", "[light]\nmap = \"\"\n");
  ASSERT_TRUE(written.ok()) << written.text();
  EXPECT_EQ(read(path("precious")), "keep");
  EXPECT_TRUE(std::filesystem::is_symlink(path("venue.toml.new"))) << "a file of somebody else";
  EXPECT_NE(read(path("venue.toml")).find("[light]"), std::string::npos);
  EXPECT_FALSE(std::filesystem::is_symlink(path("venue.toml"))) << "the planted link became the venue";
}

TEST_F(ConfigFiles, SectionWriterNamesTheFileThatItCannotWrite) {
  const Result<void> nowhere = write_section(path("nowhere/venue.toml"), "light", "[light]\nmap = \"m\"\n");
  EXPECT_EQ(nowhere.code(), ErrorCode::kNotFound);
  EXPECT_NE(nowhere.text().find("nowhere/venue.toml"), std::string::npos);
  EXPECT_NE(nowhere.text().find("No such file or directory"), std::string::npos);
  write("broken.toml", "a = \n");
  const Result<void> broken = write_section(path("broken.toml"), "light", "[light]\n");
  EXPECT_EQ(broken.code(), ErrorCode::kInconsistent);
  EXPECT_EQ(broken.text().substr(0, path("broken.toml").size() + 2), path("broken.toml") + ": ");
  EXPECT_EQ(read(path("broken.toml")), "a = \n");
}

}  // namespace
}  // namespace touchline::config
